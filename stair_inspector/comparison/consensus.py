"""Which parts of two scans moved together? The largest group that one small motion explains; the others moved."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats

_FAR = {1: 10.83, 2: 13.82, 3: 16.27}
"""Squared distances, in standard uncertainties, that a part which did not move exceeds once in a thousand times, by how
many values it has."""
_ROUNDS = 20
_LEAST_WEIGHT = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class PartMotion:
    """What one surface tells of a motion of three numbers: ``values`` (r,) = ``rows`` (r, 3) @ motion + error.

    ``covariance`` (r, r) is that of the error; ``weight`` how much the part counts in the choice of the group.
    """

    rows: Floats
    values: Floats
    covariance: Floats
    weight: float = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Consensus:
    """The motion (3,) of the group, its covariance (3, 3), and which parts (n,) belong to it."""

    motion: Floats
    covariance: Floats
    is_steady: Bools


def find_consensus(parts: Sequence[PartMotion], seeds: Sequence[Sequence[int]]) -> Consensus | None:
    """Find the motion with which the heaviest group of parts agrees best.

    Parameters
    ----------
    parts
        Surfaces.
    seeds
        Groups of parts, by their numbers, from which a motion is tried; those that determine none are passed over.

    Returns
    -------
    Consensus or None
        None where no seed determines a motion. The covariance is widened where the group scatters more than it states.

    Notes
    -----
    Sample consensus with a bounded loss [1]_: every seed is tried in place of a draw, so that the same parts give the
    same answer, and refined with Tukey's biweight. The loss counts how well a part agrees: else a motion half way
    between a flight that settled and one that did not would agree with both. Least squares, however robustly weighted,
    goes there by itself: the steps of a flight are many and alike.

    References
    ----------
    .. [1] Torr, Zisserman: MLESAC, Computer Vision and Image Understanding 78, 2000.
    """
    best, most = None, 0.0
    for seed in seeds:
        weights = np.zeros(len(parts))
        weights[list(seed)] = 1.0
        for _ in range(_ROUNDS):
            fitted = _fit(parts, weights)
            if fitted is None:
                break
            far = _distances(parts, *fitted)
            again = np.clip(1.0 - far, 0.0, None) ** 2
            if np.abs(again - weights).max() < _LEAST_WEIGHT:
                break
            weights = again
        if fitted is None:
            continue
        score = sum(part.weight * max(0.0, 1.0 - distance) for part, distance in zip(parts, far, strict=True))
        if score > most:
            best, most = (*fitted, far <= 1.0), score
    if best is None:
        return None
    motion, covariance, is_steady = best
    n_values, squares = 0, 0.0
    for part, is_in in zip(parts, is_steady, strict=True):
        if is_in:
            left = part.values - part.rows @ motion
            squares += float(left @ np.linalg.solve(part.covariance, left))
            n_values += len(left)
    excess = squares / (n_values - 3) if n_values > 3 else 1.0
    return Consensus(motion, covariance * max(1.0, excess), is_steady)


def _fit(parts: Sequence[PartMotion], weights: Floats) -> tuple[Floats, Floats] | None:
    """Return the motion of the parts by their weights, and its covariance; None where they do not determine it."""
    normal, right = np.zeros((3, 3)), np.zeros(3)
    for part, weight in zip(parts, weights, strict=True):
        if weight > _LEAST_WEIGHT:
            weighted = weight * np.linalg.solve(part.covariance, part.rows).T
            normal += weighted @ part.rows
            right += weighted @ part.values
    scale = np.sqrt(np.diag(normal))
    if not (scale > 0.0).all() or np.linalg.cond(normal / np.outer(scale, scale)) > 1e10:
        return None
    covariance = np.asarray(np.linalg.inv(normal), dtype=np.float64)
    return covariance @ right, covariance


def _distances(parts: Sequence[PartMotion], motion: Floats, covariance: Floats) -> Floats:
    """Return how far each part (n,) lies off a motion, squared, as a share of what chance allows."""
    found = []
    for part in parts:
        left = part.values - part.rows @ motion
        spread = part.covariance + part.rows @ covariance @ part.rows.T
        found.append(float(left @ np.linalg.solve(spread, left)) / _FAR[len(left)])
    return np.array(found)
