"""What did the stations of a scan see? The rays by which it is told what they looked through."""

from dataclasses import replace

import numpy as np

from stair_inspector.geometry.arrays import Ints
from stair_inspector.geometry.sight import Sight
from stair_inspector.model import Examination, Scan
from stair_inspector.stages.looked_through import is_path

_MOST_STATIONS = 16
_FEWEST_SEEN = 1000


def with_sight(scan: Scan, examined: Examination) -> Examination:
    """Keep what the stations of a scan saw.

    Parameters
    ----------
    scan, examined
        Of one file, its stations laid onto each other where they could be.

    Returns
    -------
    Examination
        Unchanged where the file does not say where stations stood, where they are the path of a scanner that is
        carried, or where they do not agree about what is empty.
    """
    stations = scan.stations
    if stations is None or any(found.code == "stations_disagree" for found in examined.observations):
        return examined
    counts = np.bincount(stations.of_point, minlength=len(stations.names))
    in_order: list[int] = np.argsort(-counts, kind="stable").tolist()
    is_known = np.isfinite(stations.places_m).all(axis=1) & (counts >= _FEWEST_SEEN)
    known: Ints = np.array([k for k in in_order if is_known[k]], dtype=np.intp)[:_MOST_STATIONS]
    if not len(known) or (len(known) > 1 and is_path(stations.places_m[known])):
        return examined
    rays, ranges = [], []
    for k in known:
        way = scan.points[stations.of_point == k] - stations.places_m[k]
        range_m = np.linalg.norm(way, axis=1)
        rays.append(way / np.maximum(range_m, 1e-9)[:, None])
        ranges.append(range_m)
    names = tuple(stations.names[k] for k in known)
    return replace(examined, sight=Sight(names, stations.places_m[known], tuple(rays), tuple(ranges)))
