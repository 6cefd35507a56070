"""Where is an edge of a step? By the end of its surface, and by the face that meets it there."""

import math
from dataclasses import dataclass, replace

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.edges import EdgeLine, Half, Sampling, find_face_edge
from stair_inspector.geometry.extents import find_extent_edge
from stair_inspector.geometry.percentiles import median
from stair_inspector.geometry.rims import find_rim_edge
from stair_inspector.params import SurveyParams
from stair_inspector.stages.near_points import BESIDE_M, FACE_BAND_M, FACE_FAR_M, FACE_NEAR_SIGMA, NearPoints
from stair_inspector.stages.sparse import SPARSE_M

FACE_NEAR_M = 0.003
_FACE_REACH_M = 0.012
_FACE_TRIES, _FACE_CENTRED = 4, 0.25
_OBSTRUCTED_M = 0.015
_OBSTACLE_INSIDE_M, _OBSTACLE_OUTSIDE_M = 0.03, 0.14
_OBSTACLE_LOW_M, _OBSTACLE_SIGMA = 0.02, 5.0
_OBSTACLE_HIGH_M = 0.06
_FEWEST_OF_OBSTACLE = 8
LEAST_SUPPORT = 0.55
LEAST_PURITY = 0.6
"""A riser hides what lies behind it: where most points in its place lie elsewhere, there is none."""
STRIP_NEAR_M, _STRIP_FAR_M = 0.006, 0.045
"""Strip of a tread behind its nosing that shows whether a proud strip lies there: behind a rounded edge."""
STRIP_STEP_M = 0.006
FEWEST_IN_STRIP = 10
NOISY_M = 0.004
BAND_SIGMA = 3.0
_FACE_AGREES_M, _AGREE_SIGMAS = 0.006, 4.0
_FACE_INSIDE_M, _FACE_ROWS = 0.004, 2.0
_BEYOND_SHARE = 0.1
"""Share of points beyond a face from which the face is an inner bar's."""
_BEHIND_SHARE = 0.3
"""Density of points behind a face, as a share of that in it, from which it is none."""


@dataclass(frozen=True, slots=True, eq=False)
class EdgeFinder:
    """Finds the edges of one step among the points near it."""

    near: NearPoints
    sampling: Sampling
    band_m: float
    params: SurveyParams
    is_barred: bool = False

    def edge(
        self,
        out: Floats,
        along: Floats,
        span: tuple[float, float],
        guess_m: float,
        is_foot: bool = True,
        is_square: bool = False,
        stop_m: float = math.inf,
    ) -> EdgeLine | None:
        """Find an edge by the surface's extent, then by the face that goes down or up from it if one is seen.

        Parameters
        ----------
        out, along : (n,)
            Coordinates of the near points square to the edge and along it.
        span : (low, high)
            Range along the edge.
        guess_m : float
            First guess.
        is_foot : bool
            Whether a face may go up from the edge, as a wall does.
        is_square : bool
            Whether the edge is known to run exactly along ``along``.
        stop_m : float
            From where on what lies outside belongs to another surface.
        """
        if span[1] - span[0] <= 4.0 * self.sampling.spacing_m:
            return None
        offset = self.near.r
        # Only what lies near this edge: the rest was gathered for the others.
        is_close = (out >= guess_m - BESIDE_M) & (out <= min(guess_m + BESIDE_M, stop_m))
        close = np.flatnonzero(is_close & (along > span[0]) & (along < span[1]))
        out, along, offset = out[close], along[close], offset[close]
        offset = offset - self._step_at(out, offset, guess_m)
        flat = np.abs(offset) <= self.band_m
        surface = out[flat], along[flat], offset[flat]
        whole = find_extent_edge(*surface, span, guess_m, self.sampling, "all", is_square)
        middle = (span[0] + span[1]) / 2.0
        guess = (guess_m, 0.0) if whole is None else (whole.at(middle), whole.slope)
        reach = max(_FACE_REACH_M, BAND_SIGMA * self.sampling.sigma_m)
        if self.sampling.spacing_m > SPARSE_M:
            # The surface's last row of points may lie so far from its edge.
            reach = max(reach, self.sampling.spacing_m)
        near_m = max(FACE_NEAR_M, FACE_NEAR_SIGMA * self.sampling.sigma_m)
        far_m = max(FACE_FAR_M, near_m + FACE_BAND_M)
        guesses: tuple[tuple[tuple[float, float], float], ...] = ((guess, reach),)
        if abs(guess[0] - guess_m) > 0.5 * reach:
            # The surface may seem to end elsewhere than it does.
            guesses += (((guess_m, 0.0), abs(guess[0] - guess_m) + reach),)
        points = out, along, offset
        down = self._face(points, span, guesses, (-near_m, -far_m), is_square)
        if down is not None and is_foot and _hangs_behind(down, *points, (near_m, far_m)):
            down = None
        up = self._face(points, span, guesses, (near_m, far_m), is_square) if is_foot else None
        half: Half = "all"
        if down is not None and (up is None or down.support >= up.support):
            half = "above"
        elif up is not None:
            half, up = "below", replace(up, is_wall=True)
        extent = whole if half == "all" else find_extent_edge(*surface, span, guess[0], self.sampling, half, is_square)
        if half == "all" and extent is not None and not is_foot and self.sampling.sigma_m > NOISY_M:
            extent = self._without_hidden_face(extent, surface, span, is_square)
        face = down if half == "above" else up
        if self.is_barred:
            extent = find_rim_edge(out[flat], along[flat], span, guess_m, self.sampling.sigma_m, is_square)
            # Every bar has faces, along the edge and square to it: one is the edge's where the outermost bar ends.
            # At a side the rim is as exact as need be, where the ends of many bars seem to be a face.
            is_edge = face is not None and face.purity >= LEAST_PURITY and not is_foot
            face = face if face is not None and is_edge and not _goes_on_beyond(face, out[flat], along[flat]) else None
        chosen = self._choose(extent, face, middle)
        if chosen is not None and chosen.source == "tread" and self._is_obstructed(out, offset, chosen.at(middle)):
            noise_m = math.hypot(chosen.noise_m, _OBSTRUCTED_M)
            chosen = replace(chosen, noise_m=noise_m, support=0.0, obstructed_m=_OBSTRUCTED_M)
        return chosen

    def _without_hidden_face(
        self, whole: EdgeLine, surface: tuple[Floats, Floats, Floats], span: tuple[float, float], is_square: bool
    ) -> EdgeLine:
        """Return where a surface ends at whose front no face was found, without the points of one that noise hides.

        Of a noisy surface points are taken so far below that a riser's are among them. Where those above the plane end
        much farther in, there is a face, and the edge is as uncertain as what it added.
        """
        middle = sum(span) / 2.0
        edge = find_extent_edge(*surface, span, whole.at(middle), self.sampling, "above", is_square)
        if edge is None:
            return whole
        added_m = whole.at(middle) - edge.at(middle)
        if added_m <= max(_FACE_INSIDE_M, BAND_SIGMA * math.hypot(whole.noise_m, edge.noise_m)):
            return whole
        return replace(edge, noise_m=math.hypot(edge.noise_m, added_m / 2.0))

    def _face(
        self,
        points: tuple[Floats, Floats, Floats],
        span: tuple[float, float],
        guesses: tuple[tuple[tuple[float, float], float], ...],
        heights: tuple[float, float],
        is_square: bool,
    ) -> EdgeLine | None:
        """Return the face found from the first guess that leads to one.

        Where it lies near the end of the reach, half of its points may lie beyond: it is looked for again from there.
        """
        middle = (span[0] + span[1]) / 2.0
        for first, reach in guesses:
            guess = first
            for _ in range(_FACE_TRIES):
                found = find_face_edge(*points, span, guess, reach, heights, self.sampling, is_square)
                if found is None or abs(found.at(middle) - guess[0]) <= _FACE_CENTRED * reach:
                    break
                guess = (found.at(middle), found.slope)
            if found is not None and found.support >= LEAST_SUPPORT:
                return found
        return None

    def _step_at(self, out: Floats, offset: Floats, guess_m: float) -> float:
        """Return how far the surface near the edge lies above its plane, as a nosing strip does."""
        is_strip = (out <= guess_m - STRIP_NEAR_M) & (out >= guess_m - _STRIP_FAR_M)
        strip = offset[is_strip & (np.abs(offset) <= self.band_m + STRIP_STEP_M)]
        return median(strip) if len(strip) >= FEWEST_IN_STRIP else 0.0

    def _is_obstructed(self, out: Floats, offset: Floats, edge_m: float) -> bool:
        """Return whether something stands at an edge, as a post does, whose shadow may be taken for the edge."""
        beside = (out >= edge_m - _OBSTACLE_INSIDE_M) & (out <= edge_m + _OBSTACLE_OUTSIDE_M)
        low_m = max(_OBSTACLE_LOW_M, _OBSTACLE_SIGMA * self.sampling.sigma_m)
        # Higher up the tread above begins.
        beside &= (offset >= low_m) & (offset <= low_m + _OBSTACLE_HIGH_M)
        return bool(np.count_nonzero(beside) >= _FEWEST_OF_OBSTACLE)

    def _choose(self, extent: EdgeLine | None, face: EdgeLine | None, middle: float) -> EdgeLine | None:
        if self.params.edge_source == "tread" or face is None:
            return extent
        if self.params.edge_source == "face" or extent is None:
            return face
        apart = face.at(middle) - extent.at(middle)
        if extent.support < LEAST_SUPPORT and apart > 0.0:
            # Seen to end along half of the edge only: what is missing in front of the face lies in a shadow.
            return face
        noise = math.hypot(extent.noise_m, face.noise_m)
        doubt = _FACE_AGREES_M + self.sampling.spacing_m + _AGREE_SIGMAS * noise
        # A tread that goes on beyond the face overhangs it, and its end is the edge. But the face's own topmost row of
        # points, a little above the plane where another station stood higher, may seem to be the tread's last.
        inside = _FACE_INSIDE_M + _FACE_ROWS * self.sampling.spacing_m + BAND_SIGMA * noise
        return face if -inside <= apart <= doubt else extent


def _hangs_behind(face: EdgeLine, out: Floats, along: Floats, offset: Floats, heights: tuple[float, float]) -> bool:
    """Return whether as much hangs below a surface behind a face as in it: bars end there, and it is no face.

    Below a whole tread there is nothing, or its underside.
    """
    ahead = face.beyond(out, along)[(-offset >= heights[0]) & (-offset <= heights[1])]
    n_behind = np.count_nonzero((ahead < -_FACE_REACH_M) & (ahead >= -priors.USUAL_BAR_M))
    density = n_behind / (priors.USUAL_BAR_M - _FACE_REACH_M)
    n_on = np.count_nonzero(np.abs(ahead) <= _FACE_REACH_M / 2.0)
    return bool(density > _BEHIND_SHARE * n_on / _FACE_REACH_M)


def _goes_on_beyond(face: EdgeLine, out: Floats, along: Floats) -> bool:
    """Return whether a surface has points beyond a face of its own, as a tread of bars has: then it is no edge's."""
    beyond = face.beyond(out, along)
    past = _FACE_REACH_M / 2.0 + BAND_SIGMA * face.noise_m
    n_beyond = np.count_nonzero((beyond > past) & (beyond <= priors.USUAL_BAR_M))
    return bool(n_beyond > _BEYOND_SHARE * np.count_nonzero((beyond > -priors.USUAL_BAR_M) & (beyond <= 0.0)))
