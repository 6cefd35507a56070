"""The scales of colours: that of heights, and that of signed distances, which is the same to both sides."""

import numpy as np

from stair_inspector.files.palettes import Rgb
from stair_inspector.geometry.arrays import Colors, Floats
from stair_inspector.pictures.legends import Ramp, colors_on

VIRIDIS: tuple[Rgb, ...] = (
    (68, 1, 84),
    (70, 50, 127),
    (54, 92, 141),
    (39, 127, 142),
    (31, 161, 135),
    (74, 194, 109),
    (159, 218, 58),
    (253, 231, 37),
)
"""Evenly spaced colours of matplotlib's viridis: even steps look even, in grey and to colour-blind eyes too."""
DIVERGING: tuple[Rgb, ...] = (
    (33, 102, 172),
    (67, 147, 195),
    (146, 197, 222),
    (209, 229, 240),
    (236, 236, 236),
    (253, 219, 199),
    (244, 165, 130),
    (214, 96, 77),
    (178, 24, 43),
)
"""ColorBrewer's RdBu from below (blue) to above (red), safe for colour-blind eyes; grey in the middle, so that it is
seen on a white page."""
NOT_COLORED: Rgb = (112, 116, 124)
"""Of points of which there is no distance to be shown."""
_LIMIT_PERCENTILE = 95.0
_LEAST_LIMIT_M = 0.0005
_MOST_LIMIT_M = 1.0


def signed_limit(distances: Floats) -> float:
    """Return a round distance at which nearly all distances lie within the scale, metres: 1, 2 or 5 and zeros."""
    known = np.abs(distances[np.isfinite(distances)])
    if not len(known):
        return _LEAST_LIMIT_M
    wanted = float(np.clip(np.percentile(known, _LIMIT_PERCENTILE), _LEAST_LIMIT_M, _MOST_LIMIT_M))
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= wanted * (1.0 - 1e-9)))


def signed_ramp(limit_m: float) -> Ramp:
    """Return the scale of signed distances with its millimetres, the same to both sides."""
    limit = limit_m * 1000.0
    ticks = tuple(
        (share, f"{sign}{limit * abs(2.0 * share - 1.0):g}")
        for share, sign in ((0.0, "−"), (0.25, "−"), (0.5, ""), (0.75, "+"), (1.0, "+"))
    )
    return Ramp(DIVERGING, ticks)


def color_signed(distances: Floats, limit_m: float) -> Colors:
    """Return the colours (n, 3) of signed distances in metres on the diverging scale; NaN is grey."""
    colors = colors_on(DIVERGING, 0.5 + 0.5 * np.nan_to_num(distances) / limit_m)
    colors[~np.isfinite(distances)] = NOT_COLORED
    return colors
