"""What did a scanner look through, and what was in its shadow? From where it stood, and where its rays ended."""

from dataclasses import dataclass, field, replace

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints

_NEIGHBOURS, _STRAYS = 8, 1
"""Rays next to a place that must agree on it, but for one: between two surfaces a ray may end anywhere."""
_WITHIN = 0.5
NEAR_M, ABOUT_M = 0.025, 0.07
"""The rays pass all around a place: their middle is nearer to it than this share of the farthest, and that so near: to
places beside an edge, or anywhere about places that nothing is near to."""
_BEHIND_M = 0.04
"""They end so far behind a place that was looked through, or before one in shadow: more than stations lie apart."""
_ENOUGH = 0.8
"""Share of the places by which a whole strip is told: edges, holes and strays spoil the others."""
_MOST_SHADOWS = 2
_NAME_CHARACTERS = 40


@dataclass(frozen=True, slots=True, eq=False)
class Looks:
    """What stations make of places (m): whether any looked through each, and for each station what it has in shadow.

    ``shadow_m`` (k, m) is how far before a place the rays of a station ended, NaN where they did not end before it.
    """

    is_through: Bools
    shadow_m: Floats

    @property
    def is_free(self) -> bool:
        """Whether nothing is at these places, but for a few of them."""
        return bool(len(self.is_through) and np.mean(self.is_through) >= _ENOUGH)


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """Where the rays of stations ended, metres.

    ``places_m`` (k, 3) where each stood; for each its ``rays`` (n, 3), unit vectors, and their ``ranges_m`` (n,).
    ``turn`` (3, 3) takes their frame into that of what is asked.
    """

    names: tuple[str, ...]
    places_m: Floats
    rays: tuple[Floats, ...]
    ranges_m: tuple[Floats, ...]
    turn: Floats = field(default_factory=lambda: np.eye(3))

    def in_frame(self, turn: Floats) -> "Sight":
        """Return the same for places in a frame into which ``turn`` (3, 3) takes that of the rays."""
        return replace(self, turn=turn)

    def points(self, most: int = 400_000) -> tuple[Floats, Ints]:
        """Return about so many points (n, 3) at most at which rays ended, asked frame, and whose (n,) each is."""
        stride = max(1, -(-sum(map(len, self.ranges_m)) // most))
        met = [
            place + ranges_m[::stride, None] * rays[::stride]
            for place, rays, ranges_m in zip(self.places_m, self.rays, self.ranges_m, strict=True)
        ]
        return np.concatenate(met) @ self.turn.T, np.repeat(np.arange(len(met)), list(map(len, met)))

    def look(self, places: Floats, reach_m: float = NEAR_M) -> Looks:
        """Return what the stations make of places (m, 3), by rays that pass them within ``reach_m``."""
        places = places @ self.turn
        is_through = np.zeros(len(places), dtype=np.bool_)
        shadow_m = np.full((len(self.names), len(places)), np.nan)
        for k in range(len(self.names)):
            seen_m, distances_m = self._around(k, places, reach_m)
            nearest, farthest = seen_m[:, _STRAYS], seen_m[:, -1 - _STRAYS]
            is_through |= nearest > distances_m + _BEHIND_M
            is_hidden = farthest < distances_m - _BEHIND_M
            shadow_m[k, is_hidden] = distances_m[is_hidden] - np.median(seen_m[is_hidden], axis=1)
        return Looks(is_through, shadow_m)

    def _around(self, k: int, places: Floats, reach_m: float) -> tuple[Floats, Floats]:
        """Return the ranges (m, 8) of the rays around places, in order, NaN where they do not tell, and distances."""
        from scipy.spatial import KDTree  # slow to load

        to = places - self.places_m[k]
        distances_m = np.linalg.norm(to, axis=1)
        towards = to / np.maximum(distances_m, 1e-9)[:, None]
        seen_m = np.full((len(places), _NEIGHBOURS), np.nan)
        margin = reach_m / max(float(distances_m.min()), reach_m)
        is_near = np.ones(len(self.rays[k]), dtype=np.bool_)
        for axis in range(3):
            along = self.rays[k][:, axis]
            is_near &= (along >= towards[:, axis].min() - margin) & (along <= towards[:, axis].max() + margin)
        rows = np.flatnonzero(is_near)
        if len(rows) < _NEIGHBOURS:
            return seen_m, distances_m
        rays = self.rays[k][rows]
        off, near = KDTree(rays, balanced_tree=False, compact_nodes=False).query(towards, k=_NEIGHBOURS)
        middle_off = np.linalg.norm(rays[near].mean(axis=1) - towards, axis=1)
        is_told = (middle_off < _WITHIN * off[:, -1]) & (off[:, -1] * distances_m < reach_m)
        seen_m[is_told] = np.sort(self.ranges_m[k][rows[near[is_told]]], axis=1)
        return seen_m, distances_m

    def words(self, looks: Looks, least: float = 0.6) -> str:
        """Return from which stations at least that share of places lies in shadow, and of what; '' where none does."""
        shown = []
        for name, ahead_m in zip(self.names, looks.shadow_m, strict=True):
            if np.mean(np.isfinite(ahead_m)) >= least:
                far = f"{max(float(np.nanmedian(ahead_m)), 0.05):.2g} m"
                shown.append(f"of something {far} in front of it, seen from station '{name[:_NAME_CHARACTERS]}'")
        return f"in the shadow {', and '.join(shown[:_MOST_SHADOWS])}" if shown else ""
