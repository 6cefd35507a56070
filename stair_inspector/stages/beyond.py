"""Does a flight go on where its measured steps end? Rows at its rhythm are seen and not measured, or the scan ends."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.plan import angle_deg, in_frame, place_in_frame
from stair_inspector.geometry.sight import Looks, Sight
from stair_inspector.model import Arc, Chains, Flight, HeightOrder, Note, Scan, StepShape
from stair_inspector.stages.climbs import find_climbs
from stair_inspector.stages.seen_ends import look_past, shadow_past
from stair_inspector.stages.survey import Survey

_MOST_ROWS = 60
_FEWEST_ROWS = 2
"""One row more may be a kerb, a box or a skirting board; two at the rhythm of a flight are the flight."""
_FEWEST_GOINGS = 1
_UPRIGHT, _LEVEL = 0.5, 0.9
"""|normal . up| up to which a point is one of an upright face, and from which one of a level surface."""
_INSET = 0.1
"""Share of the width left out at either side, where walls and stringers stand."""
_REACH_GOINGS = 0.3
"""How far from where the rhythm says a face is looked for, in goings."""
_FACE_M = 0.02
_FEWEST_POINTS, _LEAST_ACROSS = 12, 0.4
"""Points of a row, and the share of the width along which they lie."""
_AT_ONE_PLACE = 0.5
"""Share of the upright points of a row that lie in its face."""
_GOES_ON_UP = 0.35
"""A face above which as large a share of its points follows at the same place is a wall."""
_LEVEL_RISES = 0.2
"""How far from where the rhythm says a tread may lie, in rises."""
_LEVEL_M = 0.04
"""How far off a step's height what it lies on may be: a thick runner, or a mat."""
_ENOUGH_TREAD = 0.5
_OF_THE_FOOT = ("foot_unclear", "foot_tall", "treads_missing")
"""Notes that say already what is known of a flight's lower end."""
_BEHIND_GOINGS, _BEHIND_RISES = 1.0, 2.0
"""How far behind the last tread, and how high, there must be something for the scan not to end there."""

_Way = Literal["above", "below"]


@dataclass(frozen=True, slots=True, eq=False)
class _Rhythm:
    """How a flight's steps follow each other from one of its ends: plan of the level frame, metres.

    ``start`` (2,) is the middle of the nosing there, ``climb`` (2,) the direction of climb, ``height_m`` the height.
    ``arc`` is that of a flight that curves.
    """

    start: Floats
    climb: Floats
    height_m: float
    rise_m: float
    going_m: float
    half_width_m: float
    arc: Arc | None = None

    def frame_at(self, ahead_m: float) -> tuple[Floats, Floats]:
        """Return the place so far ahead on the middle line, negative below the start, and the climb there."""
        if self.arc is None:
            return self.start + ahead_m * self.climb, self.climb
        turn = self.arc.sense * ahead_m / self.arc.radius_m
        rotation = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
        return self.arc.centre_m + rotation @ (self.start - self.arc.centre_m), rotation @ self.climb

    def look_past(self, way: _Way, sight: Sight | None) -> Looks | None:
        """Return what stations make of the places that the next step would hide, None where no station is known."""
        size = self.height_m, self.rise_m, self.going_m, self.half_width_m
        return None if sight is None else look_past(self.frame_at, size, way == "above", sight)


@dataclass(frozen=True, slots=True)
class _Row:
    """What is seen of one step beyond: whether its riser's face is, and its tread."""

    has_face: bool
    has_tread: bool


def note_what_goes_on(
    heights: HeightOrder,
    chains: Chains,
    shapes: tuple[tuple[StepShape, ...], ...],
    survey: Survey,
    scan: Scan,
    sight: Sight | None = None,
) -> Survey:
    """Say of every flight what is seen of it beyond its measured steps.

    Parameters
    ----------
    heights : HeightOrder
        All points, with their normals' alignment.
    chains, shapes, survey, scan
        Of the same scan.
    sight : Sight, optional
        What stations looked through, scan axes; None where they are not known.

    Returns
    -------
    Survey
        ``Flight.goes_on`` and a note where at least two more rows of risers or treads follow at the flight's rise and
        going. A flight that ends at a landing has ended; a wall has no rows. Where a flight ends with a tread and
        nothing at all was scanned behind it, a note says that the scan ends there; where something was, but neither
        floor nor landing, that the flight may go on. Where a station looked through the place of the next step, the
        flight ends, and nothing is said.
    """
    flights: list[Flight] = []
    notes: list[Note] = []
    sight = None if sight is None else sight.in_frame(heights.level_from_scan)
    for chain, own, flight in zip(chains.chains, shapes, survey.flights, strict=True):
        kinds = [step.kind for step in survey.steps if step.step_id in flight.step_ids]
        found: list[str] = []
        is_above, is_below, has_riser = kinds[-1] == "tread", chain.base is None, False
        shadow_above, shadow_below = "", ""
        if flight.rise is not None and flight.going is not None and flight.going.n >= _FEWEST_GOINGS:
            climbs = find_climbs(chain, own)
            size = flight.rise.mean, flight.going.mean
            others = [shape for each in shapes if each is not own for shape in each]
            if is_above:
                rhythm = _rhythm_of(own[-1], climbs[-1], size)
                above = _sentence(_rows(heights, rhythm, others, "above"), "above")
                row, _ = _row(heights, rhythm, rhythm.going_m, 1, "above")
                is_above, has_riser, found = not above, row is not None and row.has_face, found + above
                beyond = rhythm.look_past("above", sight) if is_above else None
                is_above = is_above and not (beyond is not None and beyond.is_free)
                shadow_above = shadow_past(beyond, sight)
                if is_above and _is_nothing_behind(heights, rhythm):
                    lower_m = _level_behind(heights, own[-1])
                    if lower_m is None:
                        notes.append(_scan_ends(flight, heights, shadow_above, is_part=scan.part is not None))
                        is_above = False
                    # At the step's own height it is more of the step, which tells neither way.
                    elif abs(lower_m) >= max(priors.RUNNER_THICKNESS_M[0], own[-1].plane.sigma_m):
                        notes.append(_goes_on_level(flight, lower_m))
                        is_above = False
            if is_below:
                rhythm = _rhythm_of(own[0], climbs[0], size)
                below = _sentence(_rows(heights, rhythm, others, "below"), "below")
                is_below, found = not below, found + below
                beyond = rhythm.look_past("below", sight) if is_below else None
                is_below = is_below and not (beyond is not None and beyond.is_free)
                shadow_below = shadow_past(beyond, sight)
        is_told = any(note.code in _OF_THE_FOOT for note in survey.notes)
        shadows = shadow_above, shadow_below
        notes += _unseen_ends(flight, is_above, has_riser, is_below and not is_told, shadows)
        if not found:
            flights.append(flight)
            continue
        risers = f"{flight.n_risers} riser{'' if flight.n_risers == 1 else 's'} measured"
        goes_on = "; ".join((risers, *found))
        flights.append(replace(flight, goes_on=goes_on))
        notes.append(Note("goes_on", "survey", f"flight {flight.flight_id} goes on: {goes_on}"))
    return replace(survey, flights=tuple(flights), notes=(*survey.notes, *notes)) if notes else survey


def _scan_ends(flight: Flight, heights: HeightOrder, shadow: str, *, is_part: bool) -> Note:
    last = flight.step_ids[-1]
    cut, nothing = "the scan's end", f"nothing was scanned behind step {last}"
    # Outside a region or a box there may be more of it.
    is_seen = np.zeros(heights.n_scan, dtype=np.bool_)
    is_seen[heights.point_ids] = True
    if not is_seen.all():
        cut, nothing = "the region of interest", f"the region holds nothing behind step {last}"
    elif is_part:
        cut, nothing = "the box of the file that was read", f"the box holds nothing behind step {last}"
    message = (
        f"flight {flight.flight_id} is cut by {cut}: {nothing}, which is no landing; whether more risers follow is not "
        f"known{shadow}"
    )
    return Note("scan_ends", "survey", message, last)


def _is_nothing_behind(heights: HeightOrder, rhythm: _Rhythm) -> bool:
    """Return whether the scan holds nothing where the next riser, its tread or a wall would be."""
    rows = heights.between(rhythm.height_m + 0.5 * rhythm.rise_m, rhythm.height_m + _BEHIND_RISES * rhythm.rise_m)
    s, w = in_frame(heights.coordinates_m[:2, rows], *rhythm.frame_at(rhythm.going_m))
    reach_m = _REACH_GOINGS * rhythm.going_m
    is_behind = (s >= -reach_m) & (s <= _BEHIND_GOINGS * rhythm.going_m)
    is_behind &= np.abs(w) <= rhythm.half_width_m * (1.0 - 2.0 * _INSET)
    return int(np.count_nonzero(is_behind)) < _FEWEST_POINTS


def _level_behind(heights: HeightOrder, shape: StepShape) -> float | None:
    """Return by how much a level surface that goes on behind a flight's last step lies lower, metres; None without.

    It ends no flight by itself: it is another surface than the step, which may lie on it as a thick runner does.
    """
    rows = heights.between(shape.plane.z0_m - _LEVEL_M, shape.plane.z0_m + _LEVEL_M)
    s, w = in_frame(heights.coordinates_m[:2, rows], shape.origin_m, shape.climb)
    (low, high), s_high = shape.line_range, shape.extent[1]
    behind = (s >= s_high + _FACE_M) & (s <= s_high + priors.LONGEST_TREAD_M) & (w >= low) & (w <= high)
    behind &= heights.alignment[rows] >= _LEVEL
    if not _is_across(w[behind], (high - low) / 2.0):
        return None
    return float(np.median((shape.plane.z0_m + shape.plane.slope[0] * s - heights.coordinates_m[2, rows])[behind]))


def _goes_on_level(flight: Flight, lower_m: float) -> Note:
    last, way = flight.step_ids[-1], "lower" if lower_m > 0.0 else "higher"
    message = (
        f"flight {flight.flight_id} ends at step {last}, behind which a level surface goes on "
        f"{abs(lower_m) * 1000.0:.0f} mm {way}: a landing on which something lies, as a thick runner of carpet; where "
        "that lies on the treads too, its surface was measured and not the treads'"
    )
    return Note("two_levels", "survey", message, last)


def _unseen_ends(
    flight: Flight, is_above: bool, has_riser: bool, is_below: bool, shadows: tuple[str, str]
) -> list[Note]:
    """Say which ends of a flight the scan does not show: it may go on there."""
    first, last = flight.step_ids[0], flight.step_ids[-1]
    ends = []
    if is_above:
        behind = ", behind which a riser's face is seen" if has_riser else ""
        ends.append(f"its upper end was not seen: there may be more risers above step {last}{behind}{shadows[0]}")
    if is_below:
        ends.append(f"its lower end was not seen: there may be more risers below step {first}{shadows[1]}")
    return [Note("end_unseen", "survey", f"flight {flight.flight_id} may go on: {'; '.join(ends)}")] if ends else []


def _rhythm_of(shape: StepShape, climb: Floats, size: tuple[float, float]) -> _Rhythm:
    low, high = shape.line_range
    w = (low + high) / 2.0
    s = shape.front.at(w)
    return _Rhythm(shape.to_plan(s, w), climb, shape.plane.at(s, w), *size, (high - low) / 2.0, shape.arc)


def _sentence(rows: Sequence[_Row], way: _Way) -> list[str]:
    if len(rows) < _FEWEST_ROWS:
        return []
    n = len(rows)
    n_treads = sum(row.has_tread for row in rows)
    why = (
        "too little of their treads is seen"
        if n_treads >= _ENOUGH_TREAD * n
        else "their treads are hidden from the scanner"
    )
    return [f"about {n} more are seen {way}: {why}"]


def _rows(heights: HeightOrder, rhythm: _Rhythm, others: Sequence[StepShape], way: _Way) -> list[_Row]:
    """Return the rows that follow each other without a gap of more than one, the last one that is seen at the end."""
    rows: list[_Row] = []
    ahead_m, n_seen = 0.0, 0
    for k in range(1, _MOST_ROWS + 1):
        ahead_m += rhythm.going_m if way == "above" or k > 1 else 0.0
        if _is_another_flight(rhythm, others, ahead_m if way == "above" else -ahead_m, k):
            return []
        row, place_m = _row(heights, rhythm, ahead_m, k, way)
        if row is None and len(rows) > n_seen:
            break
        rows.append(row or _Row(False, False))
        if row is not None:
            n_seen = len(rows)
            ahead_m = place_m
    return rows[:n_seen] if sum(row.has_face or row.has_tread for row in rows[:n_seen]) >= _FEWEST_ROWS else []


def _row(heights: HeightOrder, rhythm: _Rhythm, ahead_m: float, k: int, way: _Way) -> tuple[_Row | None, float]:
    """Return what is seen of the k-th row whose face is expected so far ahead, and where the face is."""
    sign = 1.0 if way == "above" else -1.0
    rise_m, going_m = rhythm.rise_m, rhythm.going_m
    # Above, the face is that of the riser to the tread; below, that of the riser over it.
    low = rhythm.height_m + ((k - 1) * rise_m if way == "above" else -k * rise_m)
    high = low + rise_m
    tread_m = high if way == "above" else low
    rows = heights.between(low - _LEVEL_RISES * rise_m, high + rise_m)
    z, alignment = heights.coordinates_m[2, rows], heights.alignment[rows]
    s, w = in_frame(heights.coordinates_m[:2, rows], *rhythm.frame_at(sign * ahead_m))
    s = sign * s + ahead_m
    reach_m = _REACH_GOINGS * going_m
    half_m = rhythm.half_width_m * (1.0 - 2.0 * _INSET)
    near = (np.abs(w) <= half_m) & (s >= ahead_m - reach_m) & (s <= ahead_m + going_m)
    s, w, z, alignment = s[near], w[near], z[near], alignment[near]
    is_face = (alignment <= _UPRIGHT) & (s <= ahead_m + reach_m)
    within = is_face & (z >= low + 0.1 * rise_m) & (z <= high - 0.05 * rise_m)
    place_m = ahead_m
    has_face = False
    if np.count_nonzero(within) >= _FEWEST_POINTS:
        place_m = _mode(s[within])
        at_face = np.abs(s - place_m) <= _FACE_M
        n_face = np.count_nonzero(within & at_face)
        is_above = is_face & at_face & (z >= high + 0.25 * rise_m) & (z <= high + 0.9 * rise_m)
        has_face = bool(
            n_face >= max(_FEWEST_POINTS, _AT_ONE_PLACE * np.count_nonzero(within))
            and _is_across(w[within & at_face], half_m)
            and np.count_nonzero(is_above) <= _GOES_ON_UP * n_face
        )
    is_tread = (alignment >= _LEVEL) & (np.abs(z - tread_m) <= _LEVEL_RISES * rise_m)
    is_tread &= (s >= ahead_m + 0.1 * going_m) & (s <= ahead_m + 0.9 * going_m)
    has_tread = np.count_nonzero(is_tread) >= _FEWEST_POINTS and _is_across(w[is_tread], half_m)
    if not has_face and not has_tread:
        return None, ahead_m
    return _Row(has_face, bool(has_tread)), place_m if has_face else ahead_m


def _mode(values: Floats) -> float:
    """Return the middle of the densest stretch of two face widths."""
    ordered = np.sort(values)
    ends = np.searchsorted(ordered, ordered + 2.0 * _FACE_M, side="right")
    best = int(np.argmax(ends - np.arange(len(ordered))))
    return float(np.median(ordered[best : ends[best]]))


def _is_across(w: Floats, half_m: float) -> bool:
    if len(w) < _FEWEST_POINTS:
        return False
    low, high = np.percentile(w, [5.0, 95.0])
    return bool(high - low >= 2.0 * _LEAST_ACROSS * half_m)


def _is_another_flight(rhythm: _Rhythm, others: Sequence[StepShape], ahead_m: float, k: int) -> bool:
    """Return whether a step of another flight, which climbs the same way, lies where a row is expected."""
    place, climb = rhythm.frame_at(ahead_m)
    for other in others:
        if angle_deg(other.climb, climb) > priors.STRAIGHT_ON_DEG:
            continue
        along, aside = place_in_frame(other.to_plan(other.front.middle_m, 0.0), place, climb)
        if abs(along) <= rhythm.going_m and abs(aside) <= rhythm.half_width_m:
            rise_m = abs(other.plane.z0_m - rhythm.height_m)
            if abs(rise_m - k * rhythm.rise_m) <= 1.5 * rhythm.rise_m:
                return True
    return False
