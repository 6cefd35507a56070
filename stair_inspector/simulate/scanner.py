"""Scans a building: takes a Building and a Scanner, gives a coloured point cloud that knows what each point really is.

Open3D only proposes which triangle each ray hits, in single precision. Rays near the edge of a triangle are decided
again, and all ranges computed, in double precision with elementwise numpy: so the same seed gives the same points on
every processor.
"""

import dataclasses
import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Bools, Colors, Floats, Ints, Labels, Point, own
from stair_inspector.geometry.open3d import load_open3d
from stair_inspector.model import NON_STAIR_LABEL
from stair_inspector.simulate.shapes import Building
from stair_inspector.simulate.specs import Scanner
from stair_inspector.simulate.staircase import output_from_stair

_MISS = -1
_RAYS_AT_ONCE = 1_000_000
_RAYS_PER_SQUARE = 5.0  # Left before thinning; one square in 150 is then empty by chance.
_SQUARES_TURN_DEG = 27.0  # Merging programs know nothing of the stair: no row of squares may follow one of its edges.
_HOLE_M = 0.05  # Side of the patches in which a surface returns nothing.
_PAIRS_AT_ONCE = 4_000_000
_DECIMALS = 5  # Coordinates are rounded to 0.01 mm: far below any noise, far above what processors disagree on.
_MIXED_JUMP_M = 0.01  # Below this, a receiver sees one echo and no range in between.
_STEEPEST_GAIN = 10.0
_LIGHT = (-0.42, -0.35, 0.84)
_AMBIENT = 0.68
_CREASE_M = 0.07
_ASIDE = 0.1  # Stations stand this share of the width beside the way, left and right in turn.
_NEIGHBOURS = ((0, 1), (0, -1), (1, 0), (-1, 0))
_AROUND = tuple((row, column) for row in (-1, 0, 1) for column in (-1, 0, 1) if (row, column) != (0, 0))


@dataclass(frozen=True, slots=True)
class Station:
    """Where the scanner stood and what is wrong with the pose it reports.

    ``position`` (stair frame, metres) is true; the reported points are turned by ``tilt_rad`` about the level axis
    with azimuth ``tilt_azimuth_rad`` through the position, and then shifted by ``shift_m``. ``heading_rad`` is the
    azimuth at the middle of the field of view: that of the way at this station.
    """

    position: Point
    shift_m: Point
    tilt_rad: float
    tilt_azimuth_rad: float
    heading_rad: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class SimulatedScan:
    """A scan with its truth.

    ``points`` (n, 3) metres in the output frame, rounded to 0.01 mm; ``colors`` (n, 3) uint8; ``labels`` (n,) 0 floor,
    k top of step k, -1 anything else; ``station_ids`` (n,) into ``stations``; ``surface_ids`` (n,) into the
    building's surfaces; ``is_mixed`` (n,) marks points between two surfaces, which carry the label -1.
    """

    building: Building
    scanner: Scanner
    stations: tuple[Station, ...]
    points: Floats
    colors: Colors
    labels: Labels
    station_ids: Labels
    surface_ids: Ints
    is_mixed: Bools

    def __post_init__(self) -> None:
        n = len(self.points)
        for name, shape, dtype in (
            ("points", (n, 3), np.float64),
            ("colors", (n, 3), np.uint8),
            ("labels", (n,), np.int16),
            ("station_ids", (n,), np.int16),
            ("surface_ids", (n,), np.int64),
            ("is_mixed", (n,), np.bool_),
        ):
            object.__setattr__(self, name, own(getattr(self, name), shape, name, dtype))


def scan(building: Building, scanner: Scanner) -> SimulatedScan:
    """Scan a building from all stations.

    Parameters
    ----------
    building : Building
        What is there.
    scanner : Scanner
        How it is seen; ``scanner.seed`` decides everything random.

    Returns
    -------
    SimulatedScan
        Points station by station, in the order of the angular grid; possibly none.

    Notes
    -----
    The time is that of the rays, about a second for four million, wherever they go: it is the grid that costs, not
    the number of points. Thinning keeps one point, chosen at random, in each square of ``spacing_m`` on each plane,
    whichever station it comes from, as programs that merge stations do. The squares are turned against the edges of
    the stair, which would otherwise cut the last row of squares and make the density beside every edge the same.
    """
    caster = _Caster(building)
    poses, *streams = np.random.SeedSequence(scanner.seed).spawn(scanner.stations + 1)
    stations = place_stations(building, scanner, np.random.Generator(np.random.PCG64(poses)))
    parts: list[_Returns] = []
    for index, (station, stream) in enumerate(zip(stations, streams, strict=True)):
        rng = np.random.Generator(np.random.PCG64(stream))
        sectors = [
            _scan_sector(caster, scanner, index, station, azimuths, elevations, rng)
            for azimuths, elevations in _sectors(building, scanner, station)
        ]
        returns = _Returns.joined(sectors)
        parts.append(dataclasses.replace(returns, points=_smoothed(returns.points, scanner.smooth_m)))
    returns = _thinned(_Returns.joined(parts), caster.joint_of, scanner.spacing_m)
    if len(returns.points) > scanner.max_points:
        returns = returns.taken(np.sort(np.argsort(returns.priority, kind="stable")[: scanner.max_points]))
    labels = np.array([surface.label for surface in building.surfaces], dtype=np.int16)[returns.surface_ids]
    labels[returns.is_mixed] = NON_STAIR_LABEL
    scaled = returns.points * (1.0 + scanner.scale_percent / 100.0)
    # Adding zero turns -0.0 into 0.0, whose bytes differ.
    points = np.round(output_from_stair(building.stair, scaled), _DECIMALS) + 0.0
    return SimulatedScan(
        building=building,
        scanner=scanner,
        stations=stations,
        points=points,
        colors=returns.colors,
        labels=labels,
        station_ids=returns.station_ids,
        surface_ids=returns.surface_ids,
        is_mixed=returns.is_mixed,
    )


def place_stations(building: Building, scanner: Scanner, rng: np.random.Generator) -> tuple[Station, ...]:
    """Place the stations along the way up, and draw the errors of their poses.

    Parameters
    ----------
    building : Building
        The first station stands on its floor, the last on its upper landing, the others evenly between in plan, along
        the middles of the steps; they stand a tenth of the width left and right of the middle in turn. A scene is
        scanned from its own walking line.
    scanner : Scanner
        Number of stations, height, standoff and errors.
    rng : Generator
        Source of the errors.
    """
    stair = building.stair
    walk = building.walk
    if stair is not None:
        walk = ((-min(scanner.standoff_m, stair.floor_front_m), 0.0, 0.0), *walk)
    aside_m = _ASIDE * (stair.width_m if stair is not None else 1.0)
    drift = rng.standard_normal(3)
    drift /= math.sqrt(float((drift * drift).sum()))
    stations: list[Station] = []
    travelled, previous = 0.0, None
    for index in range(scanner.stations):
        share = 0.0 if scanner.stations == 1 else index / (scanner.stations - 1)
        (x, y, ground), heading_rad = _on_the_way(walk, share)
        aside = aside_m if index % 2 == 0 else -aside_m
        position = (
            x - aside * math.sin(heading_rad),
            y + aside * math.cos(heading_rad),
            ground + scanner.sensor_height_m,
        )
        if previous is not None:
            travelled += math.dist(position, previous)
        previous = position
        draws = rng.standard_normal(4)
        # The first station is the frame of the others.
        shifts = (draws[:3] * scanner.registration_m if index else np.zeros(3)) + drift * (
            scanner.drift_m_per_m * travelled
        )
        stations.append(
            Station(
                position=position,
                shift_m=(float(shifts[0]), float(shifts[1]), float(shifts[2])),
                tilt_rad=math.radians(scanner.tilt_deg) * float(draws[3]),
                tilt_azimuth_rad=2.0 * math.pi * float(rng.random()),
                heading_rad=heading_rad,
            )
        )
    return tuple(stations)


def _on_the_way(walk: tuple[Point, ...], share: float) -> tuple[Point, float]:
    """Return the point at a share of a line's length as seen from above, and the line's azimuth there, radians.

    Its height is that of the last corner passed, as on steps.
    """
    lengths = [math.dist(start[:2], stop[:2]) for start, stop in itertools.pairwise(walk)]
    wanted, passed = share * sum(lengths), 0.0
    piece = 0
    # A hair before a corner counts as on it: sums of lengths are not exact.
    while piece + 1 < len(lengths) and passed + lengths[piece] <= wanted + 1e-9:
        passed += lengths[piece]
        piece += 1
    (x0, y0, ground), (x1, y1, _) = walk[piece], walk[piece + 1]
    part = (wanted - passed) / lengths[piece]
    return (x0 + (x1 - x0) * part, y0 + (y1 - y0) * part, ground), math.atan2(y1 - y0, x1 - x0)


@dataclass(frozen=True, slots=True, eq=False)
class _Returns:
    """What came back to the scanner; stair frame. ``squares`` (n, 2) count spacings along the surface hit."""

    points: Floats
    colors: Colors
    station_ids: Labels
    surface_ids: Ints
    is_mixed: Bools
    squares: Ints
    priority: Floats

    def taken(self, ids: Ints) -> "_Returns":
        return _Returns(
            self.points[ids],
            self.colors[ids],
            self.station_ids[ids],
            self.surface_ids[ids],
            self.is_mixed[ids],
            self.squares[ids],
            self.priority[ids],
        )

    @staticmethod
    def joined(parts: "list[_Returns]") -> "_Returns":
        return _Returns(
            np.concatenate([part.points for part in parts]),
            np.concatenate([part.colors for part in parts]),
            np.concatenate([part.station_ids for part in parts]),
            np.concatenate([part.surface_ids for part in parts]),
            np.concatenate([part.is_mixed for part in parts]),
            np.concatenate([part.squares for part in parts]),
            np.concatenate([part.priority for part in parts]),
        )


def _thinned(returns: _Returns, joint_of: Ints, spacing_m: float) -> _Returns:
    """Keep the return with the lowest priority number in each square; surfaces with one ``joint_of`` share squares."""
    if not spacing_m:
        return returns
    column, row = returns.squares.T
    joints = joint_of[returns.surface_ids]
    order = np.lexsort((returns.priority, row, column, joints))
    is_first = np.ones(len(order), dtype=np.bool_)
    for key in (joints[order], column[order], row[order]):
        is_first[1:] &= key[1:] == key[:-1]
    is_first[1:] = ~is_first[1:]
    return returns.taken(np.sort(order[is_first]))


def _smoothed(points: Floats, radius_m: float) -> Floats:
    """Move every point to the mean of the points within the radius, itself included.

    Notes
    -----
    A grid in plain numpy, not a search tree: sums are taken in an order that no processor and no library changes.
    """
    if not radius_m or not len(points):
        return points
    cells = np.floor(points / radius_m).astype(np.int64)
    cells -= cells.min(axis=0) - 1
    n_columns, n_layers = (int(n) for n in cells[:, 1:].max(axis=0) + 2)
    keys = (cells[:, 0] * n_columns + cells[:, 1]) * n_layers + cells[:, 2]
    order = np.argsort(keys, kind="stable")
    keys, placed = keys[order], points[order]
    total, count = np.zeros_like(placed), np.zeros(len(placed))
    # Cells above each other follow each other in the order: nine runs of three cells are the neighbourhood.
    for column in [(row * n_columns + side) * n_layers for row in (-1, 0, 1) for side in (-1, 0, 1)]:
        start = np.searchsorted(keys, keys + column - 1, side="left")
        length = np.searchsorted(keys, keys + column + 1, side="right") - start
        ends = np.cumsum(length)
        first = 0
        while first < len(keys):
            paired = int(ends[first - 1]) if first else 0
            last = max(first + 1, int(np.searchsorted(ends, paired + _PAIRS_AT_ONCE, side="right")))
            n_each = length[first:last]
            mine = np.repeat(np.arange(first, last), n_each)
            offset = np.arange(len(mine)) - np.repeat(ends[first:last] - n_each - paired, n_each)
            theirs = start[mine] + offset
            apart = placed[theirs] - placed[mine]
            is_near = _dot(apart, apart) <= radius_m * radius_m
            mine, theirs = mine[is_near] - first, theirs[is_near]
            count[first:last] += np.bincount(mine, minlength=last - first)
            for axis in range(3):
                total[first:last, axis] += np.bincount(mine, placed[theirs, axis], minlength=last - first)
            first = last
    smoothed = np.zeros_like(points)
    smoothed[order] = total / count[:, None]
    return smoothed


def _on_surface(caster: "_Caster", ids: Ints, hit: Floats) -> Floats:
    """Return where on its surface each ray hits, (n, 2) metres, along two axes askew to the edges of the stair."""
    a, b = np.take_along_axis(hit, caster.flat_axes[ids], axis=1).T
    cos, sin = math.cos(math.radians(_SQUARES_TURN_DEG)), math.sin(math.radians(_SQUARES_TURN_DEG))
    return np.stack([cos * a + sin * b, cos * b - sin * a], axis=1)


def _is_hole(joint_ids: Ints, on_surface: Floats, scanner: Scanner) -> Bools:
    """Say which rays hit a patch of a surface that returns nothing, from whichever station it is looked at."""
    if not scanner.hole_share:
        return np.zeros(len(joint_ids), dtype=np.bool_)
    patches = np.floor(on_surface / _HOLE_M).astype(np.int64)
    mixed = np.full(len(joint_ids), scanner.seed, dtype=np.uint64)
    for key in (joint_ids, patches[:, 0], patches[:, 1]):
        # The finalizer of SplitMix64 (Steele, Lea, Flood, 2014): a number for each patch, in whatever order it is hit.
        mixed = (mixed ^ key.astype(np.uint64)) + np.uint64(0x9E3779B97F4A7C15)
        mixed = (mixed ^ (mixed >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        mixed = (mixed ^ (mixed >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        mixed ^= mixed >> np.uint64(31)
    chance = (mixed >> np.uint64(11)).astype(np.float64) / 2.0**53
    is_hole: Bools = chance < scanner.hole_share
    return is_hole


class _Caster:
    """Finds what rays hit, exactly."""

    def __init__(self, building: Building) -> None:
        o3d = load_open3d()
        vertices = np.asarray(building.mesh.vertices, dtype=np.float64)
        faces = np.asarray(building.mesh.faces, dtype=np.int64)
        self._scene = o3d.t.geometry.RaycastingScene()
        self._scene.add_triangles(
            o3d.core.Tensor(vertices.astype(np.float32)), o3d.core.Tensor(faces.astype(np.uint32))
        )
        self._as_tensor = o3d.core.Tensor
        self.corner = vertices[faces[:, 0]]
        self.side_a = vertices[faces[:, 1]] - self.corner
        self.side_b = vertices[faces[:, 2]] - self.corner
        normal = _cross(self.side_a, self.side_b)
        self.normal = normal / np.sqrt(_dot(normal, normal))[:, None]
        self.offset = _dot(self.normal, self.corner)
        # The two axes that a triangle's plane is seen best along.
        self.flat_axes = np.argsort(np.abs(self.normal), axis=1, kind="stable")[:, :2]
        self.flat_axes.sort(axis=1)
        self.surface_of = building.surface_of
        surfaces = building.surfaces
        self.rgb = np.array([surface.rgb for surface in surfaces], dtype=np.float64)
        # A tread and its nosing strip lie in one plane: a row of cut squares between them would show in the density.
        labels = [surface.label for surface in surfaces]
        self.joint_of = np.array(
            [index if label == NON_STAIR_LABEL else labels.index(label) for index, label in enumerate(labels)]
        )
        self.crease_axis = np.array([surface.crease[0] if surface.crease else 0 for surface in surfaces])
        self.crease_at = np.array([surface.crease[1] if surface.crease else np.inf for surface in surfaces])

    def cast(self, origin: Point, directions: Floats) -> Ints:
        """Return the triangle that each ray of a grid hits, -1 for none.

        Parameters
        ----------
        origin : three floats
            Stair frame, metres.
        directions : (rows, columns, 3)
            Unit vectors of the grid.
        """
        rows, columns = directions.shape[:2]
        rays = np.zeros((rows, columns, 6), dtype=np.float32)
        rays[..., :3] = origin
        rays[..., 3:] = directions
        hits = self._scene.cast_rays(self._as_tensor(rays))["primitive_ids"].numpy().astype(np.int64)
        hits[hits >= len(self.normal)] = _MISS
        return self._decided(origin, directions, hits)

    def _decided(self, origin: Point, directions: Floats, hits: Ints) -> Ints:
        """Decide again, in double precision, the rays whose neighbours hit something else."""
        padded = np.pad(hits, 1, mode="edge")
        rows, columns = hits.shape
        around = [padded[1 + r : 1 + r + rows, 1 + c : 1 + c + columns] for r, c in _AROUND]
        is_seam = np.zeros(hits.shape, dtype=np.bool_)
        for neighbour in around:
            is_seam |= neighbour != hits
        rays = directions[is_seam]
        nearest = np.full(len(rays), np.inf)
        decided = np.full(len(rays), _MISS, dtype=np.int64)
        for candidate in (hits, *around):
            ids = candidate[is_seam]
            range_m = self._range_if_inside(origin, rays, ids)
            is_nearer = range_m < nearest
            nearest[is_nearer] = range_m[is_nearer]
            decided[is_nearer] = ids[is_nearer]
        result = hits.copy()
        result[is_seam] = decided
        return result

    def _range_if_inside(self, origin: Point, rays: Floats, ids: Ints) -> Floats:
        """Return each ray's range to a triangle, infinite where it passes beside it.

        References
        ----------
        .. [1] Möller, Trumbore: Fast, minimum storage ray/triangle intersection, 1997.
        """
        side_a, side_b, corner = self.side_a[ids], self.side_b[ids], self.corner[ids]
        p = _cross(rays, side_b)
        determinant = _dot(side_a, p)
        is_crossing = np.abs(determinant) > 1e-15
        inverse = 1.0 / np.where(is_crossing, determinant, 1.0)
        t = np.array(origin)[None, :] - corner
        u = _dot(t, p) * inverse
        q = _cross(t, side_a)
        v = _dot(rays, q) * inverse
        range_m = _dot(side_b, q) * inverse
        slack = 1e-9  # Two triangles that share an edge must leave no gap.
        is_hit = is_crossing & (ids != _MISS) & (u >= -slack) & (v >= -slack) & (u + v <= 1.0 + slack) & (range_m > 0.0)
        return np.where(is_hit, range_m, np.inf)

    def plane_range(self, origin: Point, rays: Floats, ids: Ints) -> Floats:
        """Return each ray's range to the plane of a triangle, metres; infinite or negative where it never meets it."""
        normal = self.normal[ids]
        along = _dot(normal, rays)
        height = self.offset[ids] - (normal[:, 0] * origin[0] + normal[:, 1] * origin[1] + normal[:, 2] * origin[2])
        is_crossing = np.abs(along) > 1e-12
        return np.where(is_crossing, height / np.where(is_crossing, along, 1.0), np.inf)


def _sectors(building: Building, scanner: Scanner, station: Station) -> Iterator[tuple[Floats, Floats]]:
    """Yield azimuths and elevations, radians, of pieces of the angular grid that are small enough for memory."""
    bounds = np.asarray(building.mesh.bounds, dtype=np.float64)
    high_deg = scanner.elevation_high_deg
    x, y, z = station.position
    if z > bounds[1, 2]:
        # Nothing reaches higher than the topmost far corner: spare the rays to the sky.
        reach = math.hypot(max(bounds[1, 0] - x, x - bounds[0, 0]), max(bounds[1, 1] - y, y - bounds[0, 1]))
        high_deg = min(high_deg, scanner.elevation_step_deg - math.degrees(math.atan2(z - bounds[1, 2], reach)))
    n_rows = max(1, math.floor((high_deg - scanner.elevation_low_deg) / scanner.elevation_step_deg + 1e-9) + 1)
    n_columns = max(1, round(scanner.azimuth_width_deg / scanner.azimuth_step_deg))
    elevations = np.radians(scanner.elevation_low_deg + scanner.elevation_step_deg * np.arange(n_rows))
    azimuths = np.radians(scanner.azimuth_step_deg * (np.arange(n_columns) + 0.5) - scanner.azimuth_width_deg / 2.0)
    azimuths += station.heading_rad
    step = max(1, _RAYS_AT_ONCE // n_rows)
    for start in range(0, n_columns, step):
        yield azimuths[start : start + step], elevations


def _scan_sector(
    caster: _Caster,
    scanner: Scanner,
    index: int,
    station: Station,
    azimuths: Floats,
    elevations: Floats,
    rng: np.random.Generator,
) -> _Returns:
    """Scan one piece of the angular grid.

    All random numbers are drawn for the whole grid, so that one ray decides nothing about another.
    """
    origin = station.position
    shape = (len(elevations), len(azimuths))
    directions = np.stack(
        [
            np.cos(elevations)[:, None] * np.cos(azimuths)[None, :],
            np.cos(elevations)[:, None] * np.sin(azimuths)[None, :],
            np.broadcast_to(np.sin(elevations)[:, None], shape),
        ],
        axis=2,
    )
    chance = rng.random((4, *shape))
    noise = _patched(rng.standard_normal(shape), scanner.noise_patch_rays)
    speckle = rng.standard_normal(shape)
    angle_noise = rng.standard_normal((2, *shape)) if scanner.angle_noise_deg else None

    triangles = caster.cast(origin, directions)
    rows, columns = np.nonzero(triangles != _MISS)
    rays, ids = directions[rows, columns], triangles[rows, columns]
    range_m = caster.plane_range(origin, rays, ids)
    cosine = np.abs(_dot(rays, caster.normal[ids]))
    # Of rays that lie many to a square, most can go at once: by their own piece of surface against a small square.
    steps_rad = math.radians(scanner.azimuth_step_deg) * math.radians(scanner.elevation_step_deg)
    own_m2 = steps_rad * np.cos(elevations)[rows] * range_m * range_m / np.maximum(cosine, 1e-6)
    square_m2 = scanner.spacing_m**2 / _RAYS_PER_SQUARE
    wanted = np.minimum(1.0, own_m2 / square_m2) if square_m2 else np.ones(len(own_m2))
    hit = np.array(origin)[None, :] + rays * range_m[:, None]
    on_surface = _on_surface(caster, ids, hit)
    u_thin, u_drop, u_mixed, u_between = chance[:, rows, columns]
    is_kept = (u_thin < wanted) & (u_drop >= scanner.dropout_share) & (range_m <= scanner.range_max_m)
    is_kept &= ~_is_hole(caster.joint_of[caster.surface_of[ids]], on_surface, scanner)
    rows, columns, rays, ids = rows[is_kept], columns[is_kept], rays[is_kept], ids[is_kept]
    range_m, cosine, hit, on_surface = range_m[is_kept], cosine[is_kept], hit[is_kept], on_surface[is_kept]
    squares = np.floor(on_surface / scanner.spacing_m) if scanner.spacing_m else np.zeros((len(ids), 2))

    other_m, spacing_m = _across_edges(caster, scanner, origin, directions, elevations, triangles, (rows, columns))
    # The edge lies anywhere between this ray and the next; the beam reaches half its diameter to it.
    reach = np.minimum(1.0, scanner.beam_m / 2.0 / np.maximum(spacing_m, 1e-9))
    is_mixed = np.isfinite(other_m) & (u_mixed[is_kept] < scanner.mixed_share * reach)
    measured_m = range_m.copy()
    measured_m[is_mixed] += u_between[is_kept][is_mixed] * (other_m[is_mixed] - range_m[is_mixed])
    gain = 1.0 + scanner.incidence_gain * (1.0 / np.maximum(cosine, 1e-6) - 1.0)
    far_m = scanner.range_noise_m * range_m * range_m
    # A sigma that does not grow is left as it is: the root of its square may differ in the last place.
    sigma_m = np.sqrt(scanner.noise_m**2 + far_m * far_m) if scanner.range_noise_m else scanner.noise_m
    measured_m += sigma_m * np.minimum(gain, _STEEPEST_GAIN) * noise[rows, columns]
    # A range cannot be negative: what noise puts behind the scanner never existed.
    measured_m = np.maximum(measured_m, 0.0)

    reported = rays
    if angle_noise is not None:
        sigma = math.radians(scanner.angle_noise_deg)
        azimuth = azimuths[columns] + sigma * angle_noise[0][rows, columns]
        elevation = elevations[rows] + sigma * angle_noise[1][rows, columns]
        level = np.cos(elevation)
        reported = np.stack([level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)], axis=1)
    from_station = reported * measured_m[:, None]
    points = _turned(from_station, station) + (np.array(origin) + np.array(station.shift_m))[None, :]
    return _Returns(
        points=points,
        colors=_shaded(caster, ids, rays, hit, speckle[rows, columns]),
        station_ids=np.full(len(points), index, dtype=np.int16),
        surface_ids=caster.surface_of[ids],
        is_mixed=is_mixed,
        squares=squares.astype(np.int64),
        priority=u_thin[is_kept] / wanted[is_kept],
    )


def _across_edges(
    caster: _Caster,
    scanner: Scanner,
    origin: Point,
    directions: Floats,
    elevations: Floats,
    triangles: Ints,
    cells: tuple[Ints, Ints],
) -> tuple[Floats, Floats]:
    """Find what a ray would have hit on the other side of a range jump beside it.

    Parameters
    ----------
    cells : two (n,) arrays
        Rows and columns of the grid to look at, all of them hits.

    Returns
    -------
    (n,) metres
        Range along the ray to the surface across the edge; infinite where there is no jump.
    (n,) metres
        Distance to the neighbouring ray across the edge, at the nearer surface.

    Notes
    -----
    A difference of ranges alone is no jump: on a grazing surface and in an inner corner neighbours differ as well.
    It is one where the nearer surface's plane goes on in front of the farther hit, and the farther surface's plane
    behind the nearer hit.
    """
    rows, columns = cells
    n = len(rows)
    other, spacing = np.full(n, np.inf), np.full(n, np.inf)
    mine = triangles[rows, columns]
    for row_step, column_step in _NEIGHBOURS:
        r, c = rows + row_step, columns + column_step
        is_inside = (r >= 0) & (r < triangles.shape[0]) & (c >= 0) & (c < triangles.shape[1])
        theirs = np.full(n, _MISS, dtype=np.int64)
        theirs[is_inside] = triangles[r[is_inside], c[is_inside]]
        surface_differs = caster.surface_of[theirs] != caster.surface_of[mine]
        ids = np.flatnonzero((theirs != _MISS) & surface_differs & np.isinf(other))
        my_rays, their_rays = directions[rows[ids], columns[ids]], directions[r[ids], c[ids]]
        mine_on_mine = caster.plane_range(origin, my_rays, mine[ids])
        theirs_on_theirs = caster.plane_range(origin, their_rays, theirs[ids])
        mine_on_theirs = caster.plane_range(origin, my_rays, theirs[ids])
        theirs_on_mine = caster.plane_range(origin, their_rays, mine[ids])
        i_am_front = (mine_on_theirs > mine_on_mine + _MIXED_JUMP_M) & (
            theirs_on_mine < theirs_on_theirs - _MIXED_JUMP_M
        )
        i_am_back = (mine_on_theirs < mine_on_mine - _MIXED_JUMP_M) & (
            theirs_on_mine > theirs_on_theirs + _MIXED_JUMP_M
        )
        is_jump = np.isfinite(mine_on_theirs) & (mine_on_theirs > 0.0) & (theirs_on_mine > 0.0)
        is_jump &= i_am_front | i_am_back
        step_rad = math.radians(scanner.elevation_step_deg if row_step else scanner.azimuth_step_deg)
        nearer = np.minimum(mine_on_mine, theirs_on_theirs)
        apart = step_rad * nearer * (1.0 if row_step else np.cos(elevations)[rows[ids]])
        other[ids[is_jump]] = mine_on_theirs[is_jump]
        spacing[ids[is_jump]] = apart[is_jump]
    return other, spacing


def _patched(noise: Floats, side: int) -> Floats:
    """Return the noise averaged over squares of rays, scaled back to unit variance."""
    side = min(side, *noise.shape)
    if side == 1:
        return noise
    total = np.zeros((noise.shape[0] + side - 1, noise.shape[1] + side - 1))
    for row in range(side):
        for column in range(side):
            total[row : row + noise.shape[0], column : column + noise.shape[1]] += noise
    n_rows = np.convolve(np.ones(noise.shape[0]), np.ones(side))
    n_columns = np.convolve(np.ones(noise.shape[1]), np.ones(side))
    # Squares at the rim hold fewer rays.
    total /= np.sqrt(n_rows[:, None] * n_columns[None, :])
    start = side // 2
    return total[start : start + noise.shape[0], start : start + noise.shape[1]]


def _turned(vectors: Floats, station: Station) -> Floats:
    """Return vectors turned by the tilt of a station (Rodrigues' formula)."""
    if station.tilt_rad == 0.0:
        return vectors
    axis = np.array([[math.cos(station.tilt_azimuth_rad), math.sin(station.tilt_azimuth_rad), 0.0]])
    cos, sin = math.cos(station.tilt_rad), math.sin(station.tilt_rad)
    along = _dot(vectors, axis)[:, None]
    return vectors * cos + _cross(np.broadcast_to(axis, vectors.shape), vectors) * sin + axis * along * (1.0 - cos)


def _shaded(caster: _Caster, ids: Ints, rays: Floats, hit: Floats, speckle: Floats) -> Colors:
    """Return what a camera on the scanner would have seen: the colour in daylight, darker in inner corners."""
    normal, surface = caster.normal[ids], caster.surface_of[ids]
    towards = np.where(_dot(normal, rays) > 0.0, -1.0, 1.0)
    light = np.array([_LIGHT])
    daylight = _AMBIENT + (1.0 - _AMBIENT) * np.maximum(0.0, _dot(normal, light) * towards)
    coordinate = np.take_along_axis(hit, caster.crease_axis[surface][:, None], axis=1)[:, 0]
    corner = 1.0 - 0.3 * np.exp(-np.abs(coordinate - caster.crease_at[surface]) / _CREASE_M)
    value = caster.rgb[surface] * (daylight * corner * (1.0 + 0.03 * speckle))[:, None]
    shaded: Colors = np.clip(np.round(value), 0.0, 255.0).astype(np.uint8)
    return shaded


def _dot(a: Floats, b: Floats) -> Floats:
    """Return row-wise dot products; not by a library whose sums depend on the processor."""
    return a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] + a[:, 2] * b[:, 2]


def _cross(a: Floats, b: Floats) -> Floats:
    """Return row-wise cross products; not by a library whose sums depend on the processor."""
    return np.stack(
        [
            a[:, 1] * b[:, 2] - a[:, 2] * b[:, 1],
            a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2],
            a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0],
        ],
        axis=1,
    )
