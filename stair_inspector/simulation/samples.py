"""The bundled sample scans: each a staircase and the scanner that saw it."""

from dataclasses import replace

from stair_inspector.simulation.scanner_specs import PROFILES, Scanner
from stair_inspector.simulation.specs import Stair

DEFAULT_SAMPLE = "straight"
"""The sample that the program opens when it is given no scan."""

# At 15 bytes a point (three float32, three colours) a file stays below 3 MB.
_MAX_POINTS = 190_000


def _tripod(profile: str, *, spacing_m: float, seed: int, stations: int = 3, step_deg: float = 0.05) -> Scanner:
    """Return a tripod scanner at the foot, on the stair and at the top, with a grid fine enough for grazed treads."""
    return replace(
        PROFILES[profile],
        stations=stations,
        azimuth_step_deg=step_deg,
        elevation_step_deg=step_deg,
        spacing_m=spacing_m,
        max_points=_MAX_POINTS,
        seed=seed,
    )


SAMPLES: dict[str, tuple[Stair, Scanner]] = {
    DEFAULT_SAMPLE: (
        Stair(n_risers=10, rise_m=0.17, going_m=0.28, width_m=1.2, overhang_m=0.025),
        _tripod("tls_good", spacing_m=0.0075, seed=1),
    ),
    "long_landing": (
        Stair(
            n_risers=15,
            rise_m=0.168,
            going_m=0.29,
            width_m=1.1,
            overhang_m=0.02,
            landing_after=8,
            landing_depth_m=1.25,
            floor_width_m=1.8,
            upper_landing_m=1.1,
        ),
        _tripod("tls_fair", spacing_m=0.0085, seed=2, stations=4),
    ),
    "ceiling_clutter": (
        Stair(
            n_risers=8,
            rise_m=0.175,
            going_m=0.27,
            width_m=1.1,
            overhang_m=0.03,
            wall="left",
            ceiling=True,
            headroom_m=2.0,
            clutter=True,
            floor_front_m=1.8,
            floor_width_m=2.4,
            upper_landing_m=1.0,
        ),
        _tripod("tls_fair", spacing_m=0.013, seed=3, step_deg=0.1),
    ),
    "handheld_noisy": (
        Stair(n_risers=12, rise_m=0.175, going_m=0.26, width_m=1.0, overhang_m=0.02),
        replace(PROFILES["handheld"], spacing_m=0.007, max_points=_MAX_POINTS, seed=4),
    ),
    "defective_step": (
        Stair(
            n_risers=9,
            rise_m=0.178,
            going_m=0.28,
            width_m=1.2,
            overhang_m=0.025,
            rise_errors_m="5:+0.015",
            going_errors_m="7:-0.012",
            fall_errors_deg="3:3.43",
        ),
        _tripod("tls_good", spacing_m=0.0075, seed=5),
    ),
}
"""By name: the file is ``NAME.ply``. A fall of 6 % is 3.43 degrees."""
