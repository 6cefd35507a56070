"""Draws points as discs into a picture, the nearest in front: no display is needed, and the pixels never differ."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from stair_inspector.geometry.arrays import Bools, Colors, Floats

_Depths = np.ndarray[tuple[Any, ...], np.dtype[np.float32]]
_Numbers = np.ndarray[tuple[Any, ...], np.dtype[np.int32]]

_FINEST = 2
"""Pixels of the drawing for one of the picture, both ways: their mean makes edges smooth."""
_LARGEST_RADIUS = 14.0
"""In pixels of the drawing: a point near the eye does not become a plate."""
_SHADE_REACH = 2
_SHADE_STRENGTH = 1.1


@dataclass(frozen=True, slots=True, eq=False)
class Dots:
    """What is drawn: ``places`` (n, 2) in pixels of the picture, x to the right and y down, from its upper left corner.

    ``depths`` (n,) grow away from the eye, metres; ``colors`` (n, 3) uint8; ``radii`` (n,) pixels of the picture.
    """

    places: Floats
    depths: Floats
    colors: Colors
    radii: Floats

    def joined(self, other: "Dots") -> "Dots":
        """Return these dots and others."""
        return Dots(
            np.concatenate([self.places, other.places]),
            np.concatenate([self.depths, other.depths]),
            np.concatenate([self.colors, other.colors]),
            np.concatenate([self.radii, other.radii]),
        )


def draw_dots(dots: Dots, width: int, height: int, *, shade_m: float = 0.0) -> Colors:
    """Return a picture (height, width, 3) of the dots on white.

    Parameters
    ----------
    dots : Dots
        What lies outside of the picture is left out; so is what is no number.
    width, height : int
        Of the picture, pixels.
    shade_m : float
        A surface that lies this much farther away than what is beside it is darkened, which shows edges and steps where
        colours do not; 0 leaves the colours as they are.

    Notes
    -----
    The dots are sorted from far to near and drawn one pixel of the discs at a time. Of several values written to one
    place of an array numpy keeps the last, which is the nearest; the buffer of depths settles it between the passes.
    Darkening by depth differences is eye-dome lighting [1]_ in its simplest form.

    References
    ----------
    .. [1] C. Boucheny, "Interactive scientific visualization of large datasets", PhD thesis, Grenoble, 2009.
    """
    wide, high = width * _FINEST, height * _FINEST
    x = dots.places[:, 0] * _FINEST
    y = dots.places[:, 1] * _FINEST
    radii = np.clip(dots.radii * _FINEST, 0.5, _LARGEST_RADIUS)
    # A comparison with something that is no number is False.
    is_in = (x > -radii) & (x < wide + radii) & (y > -radii) & (y < high + radii) & np.isfinite(dots.depths)
    order = np.flatnonzero(is_in)
    order = order[np.argsort(-dots.depths[order], kind="stable")]
    column = np.floor(x[order]).astype(np.int32)
    row = np.floor(y[order]).astype(np.int32)
    depth = dots.depths[order].astype(np.float32)
    reach = radii[order].astype(np.float32) ** 2
    nearest = np.full(wide * high, np.inf, dtype=np.float32)
    owner = np.full(wide * high, -1, dtype=np.int32)
    numbers = np.arange(len(order), dtype=np.int32)
    for dx, dy in _disc(float(np.sqrt(reach.max(initial=0.25)))):
        is_covered = _is_covered(column + dx, row + dy, wide, high) & (reach >= dx * dx + dy * dy)
        place = ((row + dy) * wide + column + dx)[is_covered]
        is_nearer = depth[is_covered] < nearest[place]
        place, chosen = place[is_nearer], numbers[is_covered][is_nearer]
        nearest[place] = depth[chosen]
        owner[place] = chosen
    drawn = np.full((wide * high, 3), 255.0, dtype=np.float32)
    is_drawn = owner >= 0
    drawn[is_drawn] = dots.colors[order][owner[is_drawn]]
    if shade_m > 0.0:
        drawn *= _shade(nearest.reshape(high, wide), shade_m).reshape(-1, 1)
    small = drawn.reshape(height, _FINEST, width, _FINEST, 3).mean(axis=(1, 3))
    pixels: Colors = np.rint(small).astype(np.uint8)
    return pixels


def _disc(radius: float) -> list[tuple[int, int]]:
    """Return the pixels of a disc around its own, the innermost first."""
    n = int(radius)
    around = [(dx, dy) for dx in range(-n, n + 1) for dy in range(-n, n + 1) if dx * dx + dy * dy <= radius * radius]
    return sorted(around, key=lambda place: (place[0] ** 2 + place[1] ** 2, place))


def _is_covered(column: _Numbers, row: _Numbers, wide: int, high: int) -> Bools:
    is_covered: Bools = (column >= 0) & (column < wide) & (row >= 0) & (row < high)
    return is_covered


def _shade(nearest: _Depths, shade_m: float) -> _Depths:
    """Return the brightness (h, w) of each pixel: less where what is beside it lies nearer to the eye."""
    high, wide = nearest.shape
    padded = np.pad(nearest, _SHADE_REACH, constant_values=np.inf)
    here = np.where(np.isfinite(nearest), nearest, 0.0)
    darkness = np.zeros_like(nearest)
    shifts = [(dx, dy) for dx in (-1, 0, 1) for dy in (-1, 0, 1) if dx or dy]
    for dx, dy in shifts:
        x, y = _SHADE_REACH * (1 + dx), _SHADE_REACH * (1 + dy)
        beside = padded[y : y + high, x : x + wide]
        behind = np.where(np.isfinite(beside), here - beside, 0.0)
        darkness += np.clip(behind / shade_m, 0.0, 1.0)
    brightness: _Depths = np.exp(-_SHADE_STRENGTH * darkness / len(shifts)).astype(np.float32)
    return np.where(np.isfinite(nearest), brightness, np.float32(1.0))
