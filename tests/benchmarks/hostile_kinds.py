"""Scans of known staircases, spoilt as real files are: each kind is a function from a seed to its variants."""

import functools
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from stair_inspector.overrules import NAMED_UP
from stair_inspector.simulation.scanner import SimulatedScan
from stair_inspector.simulation.scanner import scan as scan_building
from stair_inspector.simulation.scanner_specs import PROFILES, Scanner
from stair_inspector.simulation.scenes import SCENES
from stair_inspector.simulation.specs import Stair
from stair_inspector.simulation.staircase import build, output_from_stair
from stair_inspector.units import METRES_PER_UNIT
from tests.benchmarks import hostile_buildings as buildings
from tests.synthetic import rotation

Nosing = tuple[np.ndarray, np.ndarray]
Order = Callable[[np.ndarray, int], np.ndarray]

EVEN = Stair(
    n_risers=7, rise_m=0.172, going_m=0.288, width_m=1.1, overhang_m=0.02, floor_front_m=2.2, upper_landing_m=1.6
)
"""Within every code that is held against it, by more than a millimetre."""
UNEVEN = replace(EVEN, n_risers=8, rise_m=0.16, rise_errors_m="5:0.014")
TLS = replace(PROFILES["tls_good"], spacing_m=0.007, standoff_m=1.8)
WALL_GAP_M = 0.001
YAWS_DEG = (0.0, 37.0, 45.0)


@dataclass(frozen=True, eq=False)
class Variant:
    """A scan in its file's own unit, and what is true of it.

    ``points`` (n, 3) file unit; ``nosings`` the two ends of every true nosing, metres, in the file's frame; ``truths``
    the true values of each, metres; ``uneven_step`` the step whose riser is out of the limits, where there is one;
    ``preset`` the settings that its user chooses; ``has_flight`` whether two treads or more are in view, for of fewer
    nobody tells a flight.
    """

    name: str
    points: np.ndarray
    nosings: tuple[Nosing, ...] = ()
    truths: tuple[dict[str, float | None], ...] = ()
    uneven_step: int | None = None
    is_partly_seen: bool = False
    preset: str = "tls"
    has_flight: bool = True

    @property
    def is_uneven(self) -> bool:
        """Whether a riser is out of the limits of uniformity."""
        return self.uneven_step is not None


@functools.lru_cache(maxsize=8)
def _scanned(stair: Stair, scanner: Scanner) -> SimulatedScan:
    return scan_building(build(stair), scanner)


def variant_of(
    name: str,
    stair: Stair,
    scanner: Scanner,
    turn: np.ndarray | None = None,
    spoil: Callable[[np.ndarray], np.ndarray] = lambda points: points,
    unit: str = "m",
    shift_m: tuple[float, float, float] = (0.0, 0.0, 0.0),
    points_of: Callable[[SimulatedScan], np.ndarray] = lambda scan: scan.points,
    uneven_step: int | None = None,
    is_partly_seen: bool = False,
    preset: str = "tls",
    fewest_in_view: int = 0,
) -> Variant:
    """Scan a staircase, turn and shift it, give it another unit and spoil it, in this order.

    A tread of which fewer points than ``fewest_in_view`` were measured is not in view.
    """
    simulated = _scanned(stair, scanner)
    motion = np.eye(3) if turn is None else turn
    shift = np.array(shift_m)

    def moved(points: np.ndarray) -> np.ndarray:
        return points @ motion.T + shift

    truths = [truth for truth in simulated.building.steps if not truth.is_missing]
    nosings = [moved(output_from_stair(stair, np.array(truth.nosing))) for truth in truths]
    values = []
    # Nobody sees the gaps by which the simulator's walls stand off the treads: a tread is as wide as what it fills.
    gaps_m = {"none": 0.0, "both": 2.0 * WALL_GAP_M}.get(stair.wall, WALL_GAP_M)
    for truth in truths:
        is_landing = truth.kind == "landing"
        values.append(
            {
                "rise": truth.rise_m,
                "going": None if is_landing else truth.going_m,
                "width": None if is_landing else truth.width_m + gaps_m,
            }
        )
    points = spoil(moved(points_of(simulated)) / METRES_PER_UNIT[unit])
    pairs = tuple((nosing[0], nosing[1]) for nosing in nosings)
    in_view = np.bincount(np.maximum(simulated.labels, 0), minlength=len(truths) + 1)[1:] >= fewest_in_view
    has_flight = np.count_nonzero(in_view) > 1
    return Variant(name, points, pairs, tuple(values), uneven_step, is_partly_seen, preset, has_flight)


def on_step(step_m: float) -> Callable[[np.ndarray], np.ndarray]:
    """Coordinates rounded to a step, as decimals and integer formats leave them."""
    return lambda points: np.round(points / step_m) * step_m


def voxels(side_m: float) -> Callable[[np.ndarray], np.ndarray]:
    """The centres of the cells of a lattice that hold a point."""
    return lambda points: (np.unique(np.floor(points / side_m).astype(np.int64), axis=0) + 0.5) * side_m


def yaw(degrees: float) -> np.ndarray:
    """A turn about the vertical, (3, 3)."""
    return rotation("z", degrees)


def up_along(axis: str) -> np.ndarray:
    """A turn (3, 3) that makes the vertical one of the file's axes."""
    up = np.array(NAMED_UP[axis])
    side = np.roll(np.abs(up), 1)
    return np.stack([side, np.cross(up, side), up], axis=1)


def rounded_finely(seed: int) -> Iterator[Variant]:
    """Steps of 0.1 to 5 mm, as LAS, PTS and CSV files have them; even stairs and one with a tall riser."""
    for k, step_m in enumerate((0.0001, 0.001, 0.002, 0.005)):
        for angle in YAWS_DEG:
            turn = yaw(angle)
            name = f"{1000.0 * step_m:g} mm, yaw {angle:g}, seed {seed}"
            yield variant_of(name, EVEN, replace(TLS, seed=seed), turn, on_step(step_m))
        uneven = replace(TLS, seed=seed + 10)
        yield variant_of(
            f"uneven, {1000.0 * step_m:g} mm", UNEVEN, uneven, yaw(YAWS_DEG[k % 3]), on_step(step_m), uneven_step=5
        )


def rounded_coarsely(seed: int) -> Iterator[Variant]:
    """Steps of 10 mm, and the centres of 10 and 20 mm voxels."""
    for angle in YAWS_DEG:
        for name, spoil in (
            ("10 mm", on_step(0.01)),
            ("voxels of 10 mm", voxels(0.01)),
            ("voxels of 20 mm", voxels(0.02)),
        ):
            yield variant_of(f"{name}, yaw {angle:g}, seed {seed}", EVEN, replace(TLS, seed=seed), yaw(angle), spoil)


def other_axes(seed: int) -> Iterator[Variant]:
    """Up along every axis of the file, both ways."""
    for axis in NAMED_UP:
        yield variant_of(f"up {axis}, seed {seed}", EVEN, replace(TLS, seed=seed), up_along(axis) @ yaw(20.0 * seed))


def other_units(seed: int) -> Iterator[Variant]:
    """The five units, z up."""
    for unit in METRES_PER_UNIT:
        yield variant_of(f"{unit}, seed {seed}", EVEN, replace(TLS, seed=seed), yaw(20.0 * seed), unit=unit)


def camera_at(height_m: float, away_m: float, pitch_deg: float) -> Scanner:
    """A depth camera of 80 by 60 degrees with 2 mm of noise, so far before the first riser, tilted down."""
    return Scanner(
        stations=1,
        sensor_height_m=height_m,
        standoff_m=away_m,
        azimuth_step_deg=0.22,
        elevation_step_deg=0.22,
        azimuth_width_deg=80.0,
        elevation_low_deg=-pitch_deg - 30.0,
        elevation_high_deg=-pitch_deg + 30.0,
        spacing_m=0.0,
        noise_m=0.002,
    )


def camera_views(seed: int) -> Iterator[Variant]:
    """One frame of a depth camera in its optical frame (z forward, y down) before the foot of a stair with walls."""
    rng = np.random.default_rng(seed)
    for pitch in (0.0, 10.0, 20.0, 30.0, 40.0):
        stair = replace(EVEN, n_risers=6, wall="both" if rng.uniform() < 0.5 else "left", ceiling=True)
        height_m, away_m = float(rng.uniform(1.0, 1.5)), float(rng.uniform(1.0, 1.6))
        camera = replace(camera_at(height_m, away_m, pitch), seed=seed)
        name = f"pitch {pitch:g}, seed {seed}"
        yield variant_of(name, stair, camera, optical_frame(pitch), is_partly_seen=True)


def camera_frames(seed: int) -> Iterator[Variant]:
    """Frames of a depth camera whose origin is the camera: from 1 to 4 m, of a robot or a hand, level to steep.

    Every second one as cameras that triangulate are: noise that grows with the square of the range and that
    neighbouring pixels have in common, measured with the preset of such cameras.
    """
    rng = np.random.default_rng(1000 + seed)
    for k in range(10):
        pitch = float(rng.uniform(0.0, 40.0))
        is_noisy = k % 2 == 1
        stair = replace(
            EVEN,
            n_risers=int(rng.integers(4, 10)),
            wall=str(rng.choice(["both", "left", "none"])),
            floor_front_m=4.6,
            floor_width_m=3.0,
        )
        height_m, away_m = float(rng.uniform(0.3, 1.7)), float(rng.uniform(1.0, 4.0))
        camera = replace(
            camera_at(height_m, away_m, pitch),
            range_max_m=6.0,
            range_noise_m=0.0015 if is_noisy else 0.0,
            noise_patch_rays=5 if is_noisy else 1,
            seed=100 * seed + k,
        )
        turn = optical_frame(pitch)
        place = turn @ np.array(_scanned(stair, camera).stations[0].position)
        name = (
            f"{camera.sensor_height_m:.2f} m high, {camera.standoff_m:.1f} m away, pitch {pitch:.0f}, seed {seed}-{k}"
        )
        yield variant_of(
            name,
            stair,
            camera,
            turn,
            shift_m=(-float(place[0]), -float(place[1]), -float(place[2])),
            is_partly_seen=True,
            preset="depth_camera" if is_noisy else "tls",
            fewest_in_view=1,
        )


def optical_frame(pitch_deg: float) -> np.ndarray:
    """A turn (3, 3) from the stair's axes to those of a camera that looks ahead and so far down: right, down, ahead."""
    angle = np.radians(pitch_deg)
    forward = np.array([np.cos(angle), 0.0, -np.sin(angle)])
    right = np.array([0.0, -1.0, 0.0])
    return np.stack([right, np.cross(forward, right), forward])


def from_the_foot(seed: int) -> Iterator[Variant]:
    """A long flight seen from its foot alone: most treads are above the scanner."""
    for n_risers in (11, 14):
        stair = replace(EVEN, n_risers=n_risers)
        scanner = replace(TLS, stations=1, sensor_height_m=1.5, spacing_m=0.006, seed=seed)
        yield variant_of(f"{n_risers} risers, seed {seed}", stair, scanner, is_partly_seen=True)


def sparse(seed: int) -> Iterator[Variant]:
    """Treads with 100 to 700 points, by thinning at random."""
    stair = replace(EVEN, n_risers=9, rise_m=0.17 + 0.002 * (seed % 4), width_m=1.15)
    for spacing_m in (0.02, 0.03, 0.04):
        scanner = replace(TLS, spacing_m=spacing_m, seed=seed)
        yield variant_of(f"{1000.0 * spacing_m:g} mm apart, seed {seed}", stair, scanner, yaw(30.0 * seed))


def stations_apart(seed: int) -> Iterator[Variant]:
    """Two stations that lie apart in height, along the climb, across it, or all of that."""
    for way, apart_m in (
        *(("z", apart_m) for apart_m in (0.006, 0.012, 0.014, 0.02)),
        *(("x", apart_m) for apart_m in (0.006, 0.012)),
        *(("y", apart_m) for apart_m in (0.015,)),
        *(("xyz", apart_m) for apart_m in (0.01,)),
    ):

        def points_of(simulated: SimulatedScan, way: str = way, apart_m: float = apart_m) -> np.ndarray:
            shift = np.zeros((len(simulated.points), 3))
            for axis in way:
                shift[simulated.station_ids == 1, "xyz".index(axis)] = apart_m
            return simulated.points + shift

        name = f"{1000.0 * apart_m:g} mm along {way}, seed {seed}"
        yield variant_of(name, EVEN, replace(TLS, seed=seed), points_of=points_of)


def stations_apart_unseen(seed: int) -> Iterator[Variant]:
    """Stations apart in height where noise or rounding fills the gap between the layers."""

    def points_of(simulated: SimulatedScan, apart_m: float) -> np.ndarray:
        return simulated.points + np.where(simulated.station_ids == 1, apart_m, 0.0)[:, None] * np.eye(3)[2]

    for noise_m, apart_m, step_m in ((5, 6, 0), (5, 12, 0), (5, 22, 0), (1, 12, 4), (1, 12, 5)):
        yield variant_of(
            f"{apart_m} mm, noise {noise_m} mm, on {step_m} mm, seed {seed}",
            EVEN,
            replace(TLS, noise_m=0.001 * noise_m, seed=seed),
            spoil=on_step(0.001 * step_m) if step_m else lambda points: points,
            points_of=functools.partial(points_of, apart_m=0.001 * apart_m),
        )
    for noise_m, step_m, order in ((3, 0, shuffled), (5, 0, sorted_by_place), (5, 0, halved), (1, 5, shuffled)):

        def spoil(points: np.ndarray, step_m: int = step_m, order: Order = order) -> np.ndarray:
            points = order(points, seed)
            return on_step(0.001 * step_m)(points) if step_m else points

        yield variant_of(
            f"12 mm, noise {noise_m} mm, on {step_m} mm, {order.__name__}, seed {seed}",
            EVEN,
            replace(TLS, noise_m=0.001 * noise_m, seed=seed),
            yaw(20.0 * seed),
            spoil,
            points_of=functools.partial(points_of, apart_m=0.012),
        )


def shuffled(points: np.ndarray, seed: int) -> np.ndarray:
    """The points in any order."""
    return points[np.random.default_rng(seed).permutation(len(points))]


def sorted_by_place(points: np.ndarray, seed: int) -> np.ndarray:
    """The points in the order of their coordinates."""
    return points[np.lexsort(points.T[::-1])]


def halved(points: np.ndarray, seed: int) -> np.ndarray:
    """Half of the points, in any order."""
    return shuffled(points, seed)[::2]


def treads_changed(seed: int) -> Iterator[Variant]:
    """A tread on which a board lies that one of the stations has not seen there."""

    def points_of(simulated: SimulatedScan, step: int, high_m: float) -> np.ndarray:
        points = simulated.points.copy()
        is_on = np.abs(points[:, 2] - step * EVEN.rise_m) < 0.03
        points[is_on & (simulated.station_ids == 1) & (simulated.labels == step), 2] += high_m
        return points

    for noise_m, high_m in ((1, 4), (1, 8), (3, 8)):
        step = 2 + (seed + high_m // 4) % 4
        yield variant_of(
            f"{high_m} mm on step {step}, noise {noise_m} mm, seed {seed}",
            EVEN,
            replace(TLS, noise_m=0.001 * noise_m, spacing_m=0.01, seed=seed),
            yaw(20.0),
            points_of=functools.partial(points_of, step=step, high_m=0.001 * high_m),
        )


def half_of_the_points(seed: int) -> Iterator[Variant]:
    """Half of the points, and a third, at random."""
    for share in (0.5, 0.33):

        def thinned(points: np.ndarray, share: float = share) -> np.ndarray:
            return points[np.random.default_rng(seed).uniform(size=len(points)) < share]

        yield variant_of(f"{share:g}, seed {seed}", UNEVEN, replace(TLS, seed=seed), yaw(10.0), thinned, uneven_step=5)


def far_in_float32(seed: int) -> Iterator[Variant]:
    """Map coordinates kept in single precision."""
    for shift in ((500_000.0, 5_800_000.0, 50.0), (4_000.0, 9_000.0, 20.0)):
        yield variant_of(
            f"{shift[1]:g} m, seed {seed}",
            EVEN,
            replace(TLS, seed=seed),
            yaw(15.0),
            lambda points: points.astype(np.float32).astype(np.float64),
            shift_m=shift,
        )


def obstructed(seed: int) -> Iterator[Variant]:
    """A cluttered stair between a wall and a handrail, under a ceiling."""
    stair = replace(EVEN, n_risers=9, wall="left", ceiling=True, clutter=True, floor_width_m=2.6)
    yield variant_of(
        f"clutter, seed {seed}", stair, replace(TLS, stations=3, seed=seed), yaw(-50.0), is_partly_seen=True
    )


def _built(
    name: str,
    stair: buildings.Plain,
    built: buildings.Built,
    seed: int,
    turn: np.ndarray,
    spoil: Callable[[np.ndarray], np.ndarray] = lambda points: points,
) -> Variant:
    """A scan, by three stations, of a building that the simulator's own language has no words for.

    It is spoilt before it is turned. Of two flights one comes after the other.
    """
    simulated = scan_building(built.building, replace(TLS, stations=3, seed=seed))
    nosings = [nosing @ turn.T for nosing in built.nosings]
    is_landing = [k % stair.n_risers == stair.n_risers - 1 for k in range(len(nosings))]
    truths = tuple(
        {"rise": stair.rise_m, "going": None if last else stair.going_m, "width": None if last else stair.width_m}
        for last in is_landing
    )
    points = spoil(simulated.points) @ turn.T
    return Variant(name, points, tuple((nosing[0], nosing[1]) for nosing in nosings), truths)


def without_disc(place: tuple[float, float, float], radius_m: float) -> Callable[[np.ndarray], np.ndarray]:
    """No points in a round hole of a level surface, as below a tripod."""

    def spoil(points: np.ndarray) -> np.ndarray:
        is_level = np.abs(points[:, 2] - place[2]) < 0.03
        return points[~(is_level & (np.hypot(points[:, 0] - place[0], points[:, 1] - place[1]) < radius_m))]

    return spoil


def without_strip(points: np.ndarray, low: float, high: float) -> np.ndarray:
    """No points in a strip along the climb, of the floor and landing neither."""
    return points[(points[:, 1] < low) | (points[:, 1] > high)]


def curved(seed: int) -> Iterator[Variant]:
    """Stairs on an arc, left and right."""
    stair = buildings.Plain(n_risers=9)
    for k, radius_m in enumerate((2.0, 4.0, 7.0, 10.0)):
        built = buildings.curved(stair, radius_m, is_left=(k + seed) % 2 == 0)
        yield _built(f"radius {radius_m:g} m, seed {seed}", stair, built, seed, yaw(25.0 * seed))


def of_bars(seed: int) -> Iterator[Variant]:
    """Treads of bars with gaps, along and across the climb; two flights of them side by side."""
    stair = buildings.Plain()
    for bar_m, gap_m in ((0.02, 0.03), (0.03, 0.06), (0.06, 0.012), (0.06, 0.06)):
        for is_along in (True, False):
            built = buildings.of_bars(stair, bar_m, gap_m, is_along)
            way = "along" if is_along else "across"
            name = f"bars of {1000.0 * bar_m:g}, gaps of {1000.0 * gap_m:g} mm {way}, seed {seed}"
            yield _built(name, stair, built, seed, yaw(25.0 * seed))
    for apart_m in (0.05, 0.1):
        built = buildings.beside(buildings.of_bars(stair, 0.03, 0.041, is_along=True), apart_m, stair.width_m)
        name = f"two flights of bars of 30, gaps of 41 mm, {1000.0 * apart_m:g} mm apart, seed {seed}"
        yield _built(name, stair, built, seed, yaw(25.0 * seed))


def stood_on(seed: int) -> Iterator[Variant]:
    """A person, boxes or a mat on the treads, things on the landing, a tripod's hole, a strip unseen, a runner."""
    stair = buildings.Plain()
    person, box = buildings.Thing(3, 0.05, 0.45, 0.27, 1.75), buildings.Thing(5, -0.2, 0.35, 0.25, 0.3)
    for name, things in (("a person", (person,)), ("a box", (box,)), ("both", (person, box))):
        yield _built(f"{name}, seed {seed}", stair, buildings.stood_on(stair, things), seed, yaw(25.0 * seed))
    for high_m, width_m, aside_m in ((0.004, 0.4, -0.3), (0.008, 0.7, 0.1), (0.01, 0.5, 0.25)):
        depth_m = 0.15 if width_m > 0.6 else 0.27
        mat = buildings.Thing(3, aside_m, width_m, depth_m, high_m)
        built = buildings.stood_on(stair, (mat,))
        yield _built(f"a mat of {1000.0 * high_m:g} mm, seed {seed}", stair, built, seed, yaw(25.0 * seed))
    landing = (
        buildings.Thing(stair.n_risers, -0.2, 0.45, 0.3, 1.75, 0.1),
        buildings.Thing(stair.n_risers, 0.3, 0.4, 0.4, 0.4, 0.5),
        buildings.Thing(stair.n_risers, -0.25, 0.35, 0.35, 0.4, 0.9),
        buildings.Thing(stair.n_risers, -0.25, 0.8, 0.8, 0.5, 0.65, above_m=0.6),
    )
    name = f"a person, a box and a plant on the landing, seed {seed}"
    yield _built(name, stair, buildings.stood_on(stair, landing), seed, yaw(25.0 * seed))
    for step, radius_m in ((4, 0.3), (stair.n_risers, 0.5)):
        behind_m = 0.6 if step == stair.n_risers else stair.going_m / 2.0
        spoil = without_disc(((step - 1) * stair.going_m + behind_m, 0.1, step * stair.rise_m), radius_m)
        name = f"a hole of {radius_m:g} m on step {step}, seed {seed}"
        yield _built(name, stair, buildings.stood_on(stair, ()), seed, yaw(25.0 * seed), spoil)
    for low, high in ((-0.05, 0.05), (0.1, 0.25)):
        name = f"a strip of {high - low:g} m unseen, {low:g} m aside, seed {seed}"
        built = buildings.stood_on(stair, ())
        yield _built(name, stair, built, seed, yaw(25.0 * seed), functools.partial(without_strip, low=low, high=high))
    for apart_m in (0.02, 0.03, 0.1):
        built = buildings.beside(buildings.stood_on(stair, ()), apart_m, stair.width_m)
        yield _built(f"two flights {apart_m:g} m apart, seed {seed}", stair, built, seed, yaw(25.0 * seed))
    runners = (0.006, 0.7, 0.0), (0.009, 0.9, 0.0), (0.012, 0.7, 0.0), (0.009, 0.5, 0.3), (0.018, 0.7, 0.0)
    for thick_m, width_m, aside_m in (*runners, (0.025, 0.8, 0.0), (0.018, 0.95, 0.0)):
        built = buildings.with_runner(stair, thick_m, width_m, aside_m)
        name = f"a runner of {1000.0 * thick_m:g} mm, {width_m:g} m wide, {aside_m:g} m aside, seed {seed}"
        yield _built(name, stair, built, seed, yaw(25.0 * seed))


def no_staircase(seed: int) -> Iterator[Variant]:
    """A single riser, and rooms, ramps, kerbs, shelves and boxes; finely and coarsely sampled."""
    for name, make in SCENES.items():
        simulated = scan_building(make(), replace(TLS, seed=seed))
        yield Variant(f"{name}, seed {seed}", simulated.points)
        yield Variant(f"{name} on 5 mm, seed {seed}", on_step(0.005)(simulated.points))
        yield Variant(f"{name} thinned, seed {seed}", simulated.points[:: 20 + seed])
    simulated = scan_building(build(replace(EVEN, n_risers=1)), replace(TLS, seed=seed))
    yield Variant(f"single riser, seed {seed}", simulated.points)


KINDS: dict[str, Callable[[int], Iterator[Variant]]] = {
    "coordinates on 0.1 to 5 mm": rounded_finely,
    "coordinates on 10 and 20 mm": rounded_coarsely,
    "other axes up": other_axes,
    "other units": other_units,
    "depth camera, level view": camera_views,
    "depth camera, own frame": camera_frames,
    "seen from the foot": from_the_foot,
    "sparse": sparse,
    "stations apart": stations_apart,
    "stations apart, unseen": stations_apart_unseen,
    "a tread that changed": treads_changed,
    "part of the points": half_of_the_points,
    "float32 far away": far_in_float32,
    "curved": curved,
    "treads of bars": of_bars,
    "things on the treads": stood_on,
    "clutter beside": obstructed,
    "no staircase": no_staircase,
}
"""All kinds by the name under which they are reported."""
