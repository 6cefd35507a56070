"""Scans a building: takes a Building and a Scanner, gives a coloured point cloud that knows what each point really is.

Open3D only proposes which triangle each ray hits, in single precision. Rays near the edge of a triangle are decided
again, and all ranges computed, in double precision with elementwise numpy: so the same seed gives the same points on
every processor.
"""

import dataclasses
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Bools, Colors, Floats, Ints, Labels, Point, own
from stair_inspector.model import NON_STAIR_LABEL
from stair_inspector.simulation.holes import lies_in_hole, place_on_surface
from stair_inspector.simulation.merging import ScanReturns, smooth_over, thin_out
from stair_inspector.simulation.rays import MISS, RayCaster, cross_rows, dot_rows
from stair_inspector.simulation.scanner_specs import Scanner
from stair_inspector.simulation.shapes import Building
from stair_inspector.simulation.staircase import output_from_stair
from stair_inspector.simulation.stations import Station, place_stations

_RAYS_AT_ONCE = 1_000_000
_RAYS_PER_SQUARE = 5.0  # Left before thinning; one square in 150 is then empty by chance.
_DECIMALS = 5  # Coordinates are rounded to 0.01 mm: far below any noise, far above what processors disagree on.
_MIXED_JUMP_M = 0.01  # Below this, a receiver sees one echo and no range in between.
_STEEPEST_GAIN = 10.0
_LIGHT = (-0.42, -0.35, 0.84)
_AMBIENT = 0.68
_CREASE_M = 0.07
_NEIGHBOURS = ((0, 1), (0, -1), (1, 0), (-1, 0))


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
    caster = RayCaster(building)
    poses, *streams = np.random.SeedSequence(scanner.seed).spawn(scanner.stations + 1)
    stations = place_stations(building, scanner, np.random.Generator(np.random.PCG64(poses)))
    parts: list[ScanReturns] = []
    for index, (station, stream) in enumerate(zip(stations, streams, strict=True)):
        rng = np.random.Generator(np.random.PCG64(stream))
        sectors = [
            _scan_sector(caster, scanner, index, station, azimuths, elevations, rng)
            for azimuths, elevations in _sectors(building, scanner, station)
        ]
        returns = ScanReturns.joined(sectors)
        parts.append(dataclasses.replace(returns, points=smooth_over(returns.points, scanner.smooth_m)))
    returns = thin_out(ScanReturns.joined(parts), caster.joint_of, scanner.spacing_m)
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
    caster: RayCaster,
    scanner: Scanner,
    index: int,
    station: Station,
    azimuths: Floats,
    elevations: Floats,
    rng: np.random.Generator,
) -> ScanReturns:
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
    rows, columns = np.nonzero(triangles != MISS)
    rays, ids = directions[rows, columns], triangles[rows, columns]
    range_m = caster.plane_range(origin, rays, ids)
    cosine = np.abs(dot_rows(rays, caster.normal[ids]))
    # Of rays that lie many to a square, most can go at once: by their own piece of surface against a small square.
    steps_rad = math.radians(scanner.azimuth_step_deg) * math.radians(scanner.elevation_step_deg)
    own_m2 = steps_rad * np.cos(elevations)[rows] * range_m * range_m / np.maximum(cosine, 1e-6)
    square_m2 = scanner.spacing_m**2 / _RAYS_PER_SQUARE
    wanted = np.minimum(1.0, own_m2 / square_m2) if square_m2 else np.ones(len(own_m2))
    hit = np.array(origin)[None, :] + rays * range_m[:, None]
    on_surface = place_on_surface(caster, ids, hit)
    u_thin, u_drop, u_mixed, u_between = chance[:, rows, columns]
    is_kept = (u_thin < wanted) & (u_drop >= scanner.dropout_share) & (range_m <= scanner.range_max_m)
    is_kept &= ~lies_in_hole(caster.joint_of[caster.surface_of[ids]], on_surface, scanner)
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
    return ScanReturns(
        points=points,
        colors=_shaded(caster, ids, rays, hit, speckle[rows, columns]),
        station_ids=np.full(len(points), index, dtype=np.int16),
        surface_ids=caster.surface_of[ids],
        is_mixed=is_mixed,
        squares=squares.astype(np.int64),
        priority=u_thin[is_kept] / wanted[is_kept],
    )


def _across_edges(
    caster: RayCaster,
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
        theirs = np.full(n, MISS, dtype=np.int64)
        theirs[is_inside] = triangles[r[is_inside], c[is_inside]]
        surface_differs = caster.surface_of[theirs] != caster.surface_of[mine]
        ids = np.flatnonzero((theirs != MISS) & surface_differs & np.isinf(other))
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
    along = dot_rows(vectors, axis)[:, None]
    return vectors * cos + cross_rows(np.broadcast_to(axis, vectors.shape), vectors) * sin + axis * along * (1.0 - cos)


def _shaded(caster: RayCaster, ids: Ints, rays: Floats, hit: Floats, speckle: Floats) -> Colors:
    """Return what a camera on the scanner would have seen: the colour in daylight, darker in inner corners."""
    normal, surface = caster.normal[ids], caster.surface_of[ids]
    towards = np.where(dot_rows(normal, rays) > 0.0, -1.0, 1.0)
    light = np.array([_LIGHT])
    daylight = _AMBIENT + (1.0 - _AMBIENT) * np.maximum(0.0, dot_rows(normal, light) * towards)
    coordinate = np.take_along_axis(hit, caster.crease_axis[surface][:, None], axis=1)[:, 0]
    corner = 1.0 - 0.3 * np.exp(-np.abs(coordinate - caster.crease_at[surface]) / _CREASE_M)
    value = caster.rgb[surface] * (daylight * corner * (1.0 + 0.03 * speckle))[:, None]
    shaded: Colors = np.clip(np.round(value), 0.0, 255.0).astype(np.uint8)
    return shaded
