"""What can be asked of the simulated scanner, and the scanners that exist. Imports nothing heavy."""

from dataclasses import dataclass
from typing import Annotated

from stair_inspector.declarations import DEGREES, METRES, MM, PERCENT, Group, Knob
from stair_inspector.errors import ConfigError


@dataclass(frozen=True)
class Scanner(Group):
    """A scanner, where it stands, and what it gets wrong."""

    stations: Annotated[
        int,
        Knob("stations", 1, 60, 1).says(
            "Stations {range}: the first on the floor, the last on the upper landing, the others between them."
        ),
    ] = 2
    sensor_height_m: Annotated[
        float,
        Knob("sensor height", 0.1, 3.0, 0.05, METRES).says("Height of the sensor above what it stands on, {range}."),
    ] = 1.7
    standoff_m: Annotated[
        float,
        Knob("standoff", 0.3, 9.0, 0.1, METRES).says(
            "Distance of the first station from the first riser, {range}; at most to the floor's edge."
        ),
    ] = 1.4
    azimuth_step_deg: Annotated[
        float, Knob("azimuth step", 0.02, 5.0, 0.01, DEGREES).says("Grid step around, {range}.")
    ] = 0.1
    elevation_step_deg: Annotated[
        float,
        Knob("elevation step", 0.02, 5.0, 0.01, DEGREES).says(
            "Grid step up and down, {range}; a lidar's rings lie this far apart."
        ),
    ] = 0.1
    azimuth_width_deg: Annotated[
        float,
        Knob("field of view", 10.0, 360.0, 1.0, DEGREES).says(
            "Field of view around, {range}, centred on the climbing direction."
        ),
    ] = 360.0
    elevation_low_deg: Annotated[
        float, Knob("lowest ray", -89.0, 80.0, 1.0, DEGREES).says("Lowest ray, {range}.")
    ] = -65.0
    elevation_high_deg: Annotated[
        float, Knob("highest ray", -80.0, 89.0, 1.0, DEGREES).says("Highest ray, {range}.")
    ] = 89.0
    range_max_m: Annotated[
        float, Knob("reach", 0.5, 200.0, 0.5, METRES).says("Longest range that is measured, {range}.")
    ] = 30.0
    spacing_m: Annotated[
        float,
        Knob("spacing", 0.0, 0.1, 0.001, MM).says(
            "Points are thinned to one in each square of this side on a surface, {range}; 0 keeps all."
        ),
    ] = 0.003
    max_points: Annotated[
        int,
        Knob("points at most", 100, 20_000_000, 1000).says(
            "Largest number of points {range}; more are thinned at random."
        ),
    ] = 1_000_000
    noise_m: Annotated[
        float,
        Knob("range noise", 0.0, 0.1, 0.001, MM).says("Noise along the ray at square incidence, 1 sigma, {range}."),
    ] = 0.001
    range_noise_m: Annotated[
        float,
        Knob("far noise", 0.0, 0.02, 0.0001, MM).says(
            "Noise that grows with the square of the range, as of cameras that triangulate: 1 sigma at 1 m, "
            "{range}, added in quadrature."
        ),
    ] = 0.0
    smooth_m: Annotated[
        float,
        Knob("smoothing", 0.0, 0.05, 0.001, MM).says(
            "Radius over which the device smooths its surfaces, {range}: every point goes to the mean of the "
            "points of its station within it, which rounds edges. 0 for none."
        ),
    ] = 0.0
    incidence_gain: Annotated[
        float,
        Knob("grazing noise", 0.0, 2.0, 0.05).says(
            "Growth of the noise at grazing incidence: 1 + gain * (1 / cos(incidence) - 1), at most tenfold {range}."
        ),
    ] = 0.1
    noise_patch_rays: Annotated[
        int,
        Knob("noise patch", 1, 25, 1).says(
            "Side of the square of rays over which the noise is correlated {range}; 1 for independent noise."
        ),
    ] = 1
    angle_noise_deg: Annotated[
        float, Knob("angle noise", 0.0, 1.0, 0.005, DEGREES).says("Noise of either angle, 1 sigma, {range}.")
    ] = 0.0
    beam_m: Annotated[
        float,
        Knob("beam", 0.0, 0.2, 0.001, MM).says(
            "Diameter of the beam on the surface, {range}: how near to an edge a ray must be to see both."
        ),
    ] = 0.006
    mixed_share: Annotated[
        float,
        Knob("mixed pixels", 0.0, 1.0, 0.01).says(
            "Share of the rays that straddle an edge and get a range between front and back surface {range}."
        ),
    ] = 0.02
    dropout_share: Annotated[
        float, Knob("dropouts", 0.0, 0.99, 0.01).says("Share of the rays that return nothing {range}.")
    ] = 0.01
    hole_share: Annotated[
        float,
        Knob("holes", 0.0, 0.9, 0.01).says(
            "Share of the surfaces that returns nothing to any station, in patches of 5 cm {range}."
        ),
    ] = 0.0
    registration_m: Annotated[
        float,
        Knob("registration", 0.0, 0.1, 0.001, MM).says(
            "Shift of every station but the first, 1 sigma for each axis, {range}."
        ),
    ] = 0.0
    tilt_deg: Annotated[
        float,
        Knob("station tilt", 0.0, 2.0, 0.01, DEGREES).says(
            "Tilt of every station about a random level axis, 1 sigma, {range}."
        ),
    ] = 0.0
    drift_m_per_m: Annotated[
        float,
        Knob("drift", 0.0, 0.05, 0.001).says(
            "Drift in one random direction, metres for each metre of way from the first station {range}."
        ),
    ] = 0.0
    scale_percent: Annotated[
        float,
        Knob("scale error", -5.0, 5.0, 0.1, PERCENT).says(
            "Error of scale of all coordinates about the foot of the stair, {range}."
        ),
    ] = 0.0
    seed: Annotated[
        int, Knob("seed", 0, 2**31 - 1, 1).says("Seed of everything random; the same seed, the same file.")
    ] = 1

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.elevation_high_deg - self.elevation_low_deg < self.elevation_step_deg:
            raise ConfigError(
                f"scanner.elevation_high_deg: got {self.elevation_high_deg:g} with a lowest ray at "
                f"{self.elevation_low_deg:g}; give at least one step more"
            )


# Sources: data sheets and indoor tests of the Leica RTC360 and BLK360, FARO Focus, ZEB Horizon, Ouster OS1, Livox
# Mid-360, RealSense D435, Azure Kinect and tablet lidar; each profile stands for its class, not for a product.
PROFILES: dict[str, Scanner] = {
    "tls_good": Scanner(tilt_deg=0.01, registration_m=0.0005, mixed_share=0.01),
    "tls_fair": Scanner(
        noise_m=0.003, spacing_m=0.005, registration_m=0.002, tilt_deg=0.05, mixed_share=0.02, dropout_share=0.03
    ),
    "handheld": Scanner(
        stations=12,
        sensor_height_m=1.3,
        azimuth_step_deg=0.5,
        elevation_step_deg=0.5,
        spacing_m=0.008,
        noise_m=0.01,
        angle_noise_deg=0.05,
        beam_m=0.015,
        mixed_share=0.05,
        dropout_share=0.05,
        registration_m=0.002,
        drift_m_per_m=0.002,
        tilt_deg=0.2,
    ),
    "robot_lidar": Scanner(
        stations=20,
        sensor_height_m=0.4,
        azimuth_step_deg=0.2,
        elevation_step_deg=1.0,
        elevation_low_deg=-45.0,
        elevation_high_deg=45.0,
        spacing_m=0.01,
        noise_m=0.015,
        angle_noise_deg=0.05,
        beam_m=0.018,
        mixed_share=0.05,
        dropout_share=0.05,
        registration_m=0.003,
        drift_m_per_m=0.002,
        tilt_deg=0.2,
    ),
    "depth_camera": Scanner(
        stations=10,
        sensor_height_m=1.5,
        azimuth_step_deg=0.15,
        elevation_step_deg=0.15,
        azimuth_width_deg=85.0,
        elevation_low_deg=-70.0,
        elevation_high_deg=-12.0,
        range_max_m=3.5,
        spacing_m=0.006,
        # 6 mm at 1.5 m, 16 mm at 2.5 m; smoothing leaves edges with a radius of 5 to 8 mm.
        noise_m=0.002,
        range_noise_m=0.0025,
        smooth_m=0.012,
        noise_patch_rays=5,
        beam_m=0.01,
        mixed_share=0.1,
        dropout_share=0.1,
        hole_share=0.03,
        registration_m=0.003,
        drift_m_per_m=0.003,
        tilt_deg=0.3,
    ),
    "phone": Scanner(
        stations=12,
        sensor_height_m=1.4,
        azimuth_step_deg=0.3,
        elevation_step_deg=0.3,
        azimuth_width_deg=70.0,
        elevation_low_deg=-70.0,
        elevation_high_deg=-5.0,
        range_max_m=5.0,
        spacing_m=0.01,
        noise_m=0.008,
        smooth_m=0.015,
        noise_patch_rays=7,
        beam_m=0.02,
        mixed_share=0.2,
        dropout_share=0.05,
        registration_m=0.005,
        drift_m_per_m=0.003,
        tilt_deg=0.5,
        scale_percent=0.5,
    ),
}
"""Scanners by class, from figures that were published for them."""
