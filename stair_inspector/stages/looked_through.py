"""Did one station of a file look through what another saw? Then one of them does not lie where the file has it."""

from dataclasses import dataclass, replace

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints
from stair_inspector.model import Examination, Observation, Scan, ScanStations
from stair_inspector.stages.examine import size_text

_SAY_THE_SAME = ("surfaces_doubled", "doubled_by_order", "cloud_copied")
_MOST_SEEN, _MOST_ASKED = 200_000, 10_000
"""Points of a station by which it is told what it saw, and points of each other one that are looked for in it."""
_MOST_STATIONS = 16
_FEWEST_SEEN, _FEWEST_MET = 1000, 300
_NEIGHBOURS = 12
_WITHIN, _REACH_M = 0.5, 0.06
"""The neighbours lie all around a point: their middle is nearer than this share of the farthest, and that within so
much; at the rim of what a station saw nothing is told."""
_THROUGH_M, _MOST_M = 0.015, 0.4
"""All neighbours lie so much farther away, and the next point of the station lies so far off but no farther. Noise and
edges do less; what lies farther off is a thing that one station saw and that was gone for the other."""
_LEAST_SHARE = 0.02
"""Sound stations of simulated tripods show at most 0.2 %; stations 78 mm aside 7 % where points are dense."""
_LEAST_WAY_M = 0.8
"""Places nearer to each other are the path of a scanner that is carried, whose preset states what its drift leaves, or
one origin for all, as in files whose poses were unified."""


@dataclass(frozen=True, slots=True, eq=False)
class _Through:
    """Station ``by`` looked through this ``share`` of what it met of ``of``, up to so far from its own points."""

    by: int
    of: int
    share: float
    apart_m: float


def say_looked_through(scan: Scan, examined: Examination) -> Examination:
    """Say which two stations disagree most about what is empty.

    Parameters
    ----------
    scan, examined
        Of one file, its stations laid onto each other where they could be.

    Returns
    -------
    Examination
        Unchanged where no two disagree, where the file does not say where they stood, or where surfaces are double.

    Notes
    -----
    A beam that met a surface met nothing before it. Where all beams of one station next to a point of another ended
    well behind it, and the station has no point of its own near it, one of the two is not where the file has it.
    Leans, shifts that are too large to see two layers, and shifts along the treads show so.
    """
    is_said = any(each.code in _SAY_THE_SAME for each in examined.observations)
    if scan.stations is None or scan.is_outward is not None or is_said:
        return examined
    found = _find(scan.points, scan.stations)
    if found is None:
        return examined
    return replace(examined, observations=(*examined.observations, _observe(scan.stations.names, found)))


def _observe(names: tuple[str, ...], found: _Through) -> Observation:
    by, of = names[found.by], names[found.of]
    message = (
        f"stations '{by}' and '{of}' do not agree: '{by}' looked through {found.share:.0%} of what '{of}' shows in "
        f"front of it, up to {size_text(found.apart_m)} from its own surfaces; one of them does not lie where the file "
        "has it, or things were moved between them"
    )
    cure = (
        f"measure each by itself, with --station '#{found.by + 1}' or --station '#{found.of + 1}', or register the "
        "stations once more, cloud to cloud against floor and walls"
    )
    return Observation("stations_disagree", "doubt", message, found.apart_m, cure)


def _find(points: Floats, stations: ScanStations) -> _Through | None:
    """Return where the largest share was looked through, None where it is small everywhere."""
    counts = np.bincount(stations.of_point, minlength=len(stations.names))
    is_there = np.isfinite(stations.places_m).all(axis=1) & (counts >= _FEWEST_SEEN)
    known: Ints = np.array(
        [k for k in np.argsort(-counts, kind="stable")[:_MOST_STATIONS] if is_there[k]], dtype=np.intp
    )
    if len(known) < 2 or is_path(stations.places_m[known]):
        return None
    rows = {int(k): np.flatnonzero(stations.of_point == k) for k in known}
    best: _Through | None = None
    for by in rows:
        place = stations.places_m[by]
        others = [k for k in rows if k != by]
        asked = np.concatenate([_few(rows[k], _MOST_ASKED) for k in others])
        is_met, is_through, apart_m = _looked(points[_few(rows[by], _MOST_SEEN)], place, points[asked])
        for of in others:
            is_own = stations.of_point[asked] == of
            n_met = int(np.count_nonzero(is_met & is_own))
            share = int(np.count_nonzero(is_through & is_own)) / max(n_met, 1)
            if n_met >= _FEWEST_MET and share >= max(_LEAST_SHARE, 0.0 if best is None else best.share):
                best = _Through(by, of, share, float(np.percentile(apart_m[is_through & is_own], 90.0)))
    return best


def is_path(places_m: Floats) -> bool:
    """Return whether most of the places (k, 3) stand near another."""
    between_m = np.linalg.norm(places_m[:, None] - places_m[None], axis=2)
    np.fill_diagonal(between_m, np.inf)
    return bool(np.median(between_m.min(axis=1)) < _LEAST_WAY_M)


def _looked(seen: Floats, place: Floats, asked: Floats) -> tuple[Bools, Bools, Floats]:
    """Return what one station makes of points (m, 3) of others, by what it saw (n, 3) from its place.

    Which lie before or on that, which were looked through, and how far these lie from it, NaN of the others.
    """
    from scipy.spatial import KDTree  # slow to load

    way, to = seen - place, asked - place
    ranges, distances = np.linalg.norm(way, axis=1), np.linalg.norm(to, axis=1)
    rays, towards = way / np.maximum(ranges, 1e-9)[:, None], to / np.maximum(distances, 1e-9)[:, None]
    off, near = KDTree(rays, balanced_tree=False, compact_nodes=False).query(towards, k=_NEIGHBOURS)
    middle_off = np.linalg.norm(rays[near].mean(axis=1) - towards, axis=1)
    is_within = (middle_off < _WITHIN * off[:, -1]) & (off[:, -1] * distances < _REACH_M)
    is_met: Bools = is_within & (distances < ranges[near].max(axis=1) + _THROUGH_M)
    is_through: Bools = is_within & (distances < ranges[near].min(axis=1) - _THROUGH_M)
    apart_m = np.full(len(asked), np.nan)
    if is_through.any():
        tree = KDTree(seen, balanced_tree=False, compact_nodes=False)
        apart_m[is_through] = tree.query(asked[is_through], distance_upper_bound=_MOST_M)[0]
    is_through &= (apart_m > _THROUGH_M) & (apart_m < _MOST_M)
    return is_met, is_through, apart_m


def _few(rows: Ints, most: int) -> Ints:
    """Return at most so many of the rows, evenly."""
    return rows[:: -(-len(rows) // most)]
