"""Why is a surface no step? And what has the inspector decided about it?"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from stair_inspector import priors
from stair_inspector.errors import ConfigError
from stair_inspector.geometry.arrays import Floats, Ints, freeze
from stair_inspector.geometry.plan import cell_keys
from stair_inspector.model import Chains, Horizontal, Patches, Scan, Surface
from stair_inspector.overrules import ForcedKind, OverrulesParams, parse_force, parse_up
from stair_inspector.params import FlightsParams
from stair_inspector.stages.region import find_cut_faces

_LINE_M = 0.02
_OVER_SHARE = 0.3
_SAME_HEIGHT_M = 0.04
_REACH_M = 0.5
"""How far a surface may be from the point by which the inspector means it."""
_UNDER_SHARE = 0.5
_SAME_WAY = math.cos(math.radians(45.0))
_LEAST_LEVEL = 0.2
"""A direction that is steeper than 78 degrees says nothing about the plan."""


@dataclass(frozen=True, slots=True, eq=False)
class Forced:
    """The inspector's decisions: kinds by surface number, and the direction of climb in plan, (2,), level frame.

    ``reasons`` holds the inspector's own words, for the surfaces for which some were given; ``cut`` the surfaces that
    the region of interest cuts through, and which way its faces look there.
    """

    kinds: dict[int, ForcedKind]
    climb: Floats | None = None
    reasons: dict[int, str] = field(default_factory=dict)
    cut: dict[int, tuple[Floats, ...]] = field(default_factory=dict)

    def is_cut(self, number: int, way: Floats) -> bool:
        """Return whether the region of interest cuts a surface off on the side that lies in a direction, (2,)."""
        return any(float(way @ face) > _SAME_WAY for face in self.cut.get(number, ()))

    def those(self, kind: ForcedKind) -> frozenset[int]:
        """Return the surfaces decided to be of a kind."""
        return frozenset(number for number, known in self.kinds.items() if known == kind)

    def why_rejected(self, number: int) -> str | None:
        """Return the sentence for a surface that the inspector rejected, None for any other."""
        if self.kinds.get(number) != "rejected":
            return None
        reason = self.reasons.get(number)
        return "rejected by the inspector" + (f": {reason}" if reason else "")


def apply_overrules(scan: Scan, horizontal: Horizontal, patches: Patches, params: OverrulesParams) -> Forced:
    """Find what the inspector's decisions mean in this scan; a later decision replaces an earlier one.

    Parameters
    ----------
    scan, horizontal, patches
        Of one scan; level frame.
    params : OverrulesParams
        Levels and patches by number, or points in the scan frame, and what they are; direction of climb.

    Raises
    ------
    ConfigError
        There is no such level or patch, or the direction of climb is upright.
    """
    surfaces = patches.surfaces
    kinds: dict[int, ForcedKind] = {}
    reasons: dict[int, str] = {}
    for force in parse_force(params.force):
        if force.target == "at":
            point = horizontal.level_from_scan @ (np.array(force.point_m) - scan.origin_m)
            if not surfaces:
                raise ConfigError("overrules.force: there is no surface to decide about; check theta_th, eps_z and m")
            distances = [_distance(surface, point) for surface in surfaces]
            chosen = [int(np.argmin(distances))] if min(distances) <= _REACH_M else []
        elif force.target == "patch":
            chosen = [force.number] if 0 <= force.number < len(surfaces) else []
        else:
            chosen = [k for k, surface in enumerate(surfaces) if surface.level_id == force.number]
        if not chosen:
            if force.target == "at":
                place = ",".join(f"{coordinate:g}" for coordinate in force.point_m)
                raise ConfigError(f"overrules.force: no surface lies within {_REACH_M:g} m of {place}; check the point")
            raise ConfigError(
                f"overrules.force: there is no {force.target} {force.number} with these settings; numbers change with "
                "them, so give the place instead, as at:x,y,z=kind"
            )
        kinds.update(dict.fromkeys(chosen, force.kind))
        reasons.update(dict.fromkeys(chosen, force.reason))
    cut = find_cut_faces(scan, horizontal, patches, params.region)
    given = parse_up(params.climb, "overrules.climb")
    if given is None:
        return Forced(kinds, reasons=reasons, cut=cut)
    climb = (horizontal.level_from_scan @ np.array(given))[:2]
    length = float(np.hypot(*climb))
    if length < _LEAST_LEVEL:
        raise ConfigError(f"overrules.climb: {params.climb} points up or down; give a direction in plan")
    return Forced(kinds, freeze(climb / length), reasons, cut)


def may_be_step(surface: Surface, min_area_m2: float) -> bool:
    """Return whether a surface is large and level enough to be part of a staircase, and more than a line of points."""
    is_level = lean_deg(surface) <= priors.STEEPEST_TREAD_DEG
    # Of a tread only a strip may be seen, but a line of points is none.
    return surface.area_m2 >= min_area_m2 and is_level and narrow_side(surface) >= _LINE_M


def find_undersides(patches: Patches) -> frozenset[int]:
    """Return the surfaces that lie closely under another one: undersides of treads, as of open stairs from below."""
    surfaces = patches.surfaces
    order = sorted(range(len(surfaces)), key=lambda k: surfaces[k].height_m)
    thinnest, thickest = priors.SLAB_THICKNESS_M
    found = set()
    keys: dict[int, Ints] = {}
    for position, lower in enumerate(order):
        for upper in order[position + 1 :]:
            gap_m = surfaces[upper].height_m - surfaces[lower].height_m
            if gap_m > thickest:
                break
            if gap_m < thinnest:
                continue
            for k in (lower, upper):
                if k not in keys:
                    keys[k] = plan_keys(surfaces[k], 2.0 * patches.cell_m)
            if np.isin(keys[lower], keys[upper]).mean() >= _UNDER_SHARE:
                found.add(lower)
    return frozenset(found)


def lean_deg(surface: Surface) -> float:
    """Return the angle of a surface from level, degrees."""
    return math.degrees(math.atan(float(np.hypot(*surface.slope))))


def explain_rejects(
    patches: Patches,
    chains: Chains,
    forced: Forced,
    taken: frozenset[int],
    least_area_m2: float,
    limits: FlightsParams,
) -> dict[int, str]:
    """Return for every surface that is no part of a staircase the sentence why.

    Parameters
    ----------
    patches, chains, forced
        Of one scan.
    taken : set of int
        Surfaces that are steps, landings or floor.
    least_area_m2 : float
        Smallest area of a tread.
    limits : FlightsParams
        Heights of a riser, and how near in plan the step below it lies.
    """
    surfaces = patches.surfaces
    side_m = 2.0 * patches.cell_m
    keys = [plan_keys(surface, side_m) for surface in surfaces]
    undersides = find_undersides(patches)
    steps = [k for chain in chains.chains for k in chain.steps]
    bases = sorted({chain.base for chain in chains.chains if chain.base is not None})
    tops = [surfaces[chain.steps[-1]] for chain in chains.chains]
    reasons = {}
    for number in range(len(surfaces)):
        if number in taken:
            continue
        over = [surfaces[k] for k in {*steps, *bases} if np.isin(keys[number], keys[k]).mean() >= _OVER_SHARE]
        own = forced.why_rejected(number)
        if own is None and number in undersides:
            own = "lies closely under another surface: the underside of a tread or slab"
        own = own or _why_by_itself(surfaces[number], least_area_m2)
        reasons[number] = own or _why_there(
            surfaces[number], [surfaces[k] for k in steps], [surfaces[k] for k in bases], tops, over, limits
        )
    return reasons


def _why_there(
    surface: Surface,
    steps: Sequence[Surface],
    bases: Sequence[Surface],
    tops: Sequence[Surface],
    over: Sequence[Surface],
    limits: FlightsParams,
) -> str:
    """Return why a surface that may be a step by itself is none where it lies.

    ``over`` are the steps and floors under or over it, ``tops`` the flights' last steps.
    """
    if not steps:
        return "no second and third surface a riser apart follow it in plan, as the steps of a flight would"
    gaps = [surface.height_m - other.height_m for other in over]
    if any(-priors.DEEPEST_BELOW_M <= gap < -_SAME_HEIGHT_M for gap in gaps):
        depth_m = max(gap for gap in gaps if gap < -_SAME_HEIGHT_M)
        return f"lies {-depth_m * 1000.0:.0f} mm under a step: the underside of a slab, or what stands below the stairs"
    rise_m = _rise_from_beside(surface, tops, limits)
    if rise_m is not None:
        return (
            f"lies {rise_m * 1000.0:.0f} mm above the last step of a flight and beside it, but no edge was seen along "
            "which the flight goes on: a landing seen in part, or furniture"
        )
    standing = min((gap for gap in gaps if gap > 0.0), default=None)
    over_top_m = surface.height_m - max(other.height_m for other in steps)
    if (standing is not None and standing >= priors.HEADROOM_M) or over_top_m >= priors.HEADROOM_M:
        over_m = over_top_m if standing is None else standing
        is_over_step = any(surface.height_m - step.height_m == over_m for step in steps)
        below = "steps" if is_over_step else "floor"
        return f"{over_m:.2f} m above the {below}: a ceiling or the storey above"
    if any(abs(surface.height_m - other.height_m) <= _SAME_HEIGHT_M for other in bases):
        return "at the height of the floor at which the stairs begin, but apart from it: floor elsewhere, as next door"
    if standing is not None and priors.FURNITURE_M[0] <= standing <= priors.FURNITURE_M[1]:
        return f"stands {standing:.2f} m above a step or the floor: a table, a seat or other furniture"
    if any(abs(surface.height_m - step.height_m) <= _SAME_HEIGHT_M for step in steps):
        return "at the height of a step but apart from it: furniture or another room"
    return "no step of the stairs is a riser above or below it and beside it in plan"


def _rise_from_beside(surface: Surface, tops: Sequence[Surface], limits: FlightsParams) -> float | None:
    """Return how far a surface lies above a flight's last step that ends a riser below it and beside it, metres."""
    beside_m = limits.max_gap_m
    low, high = surface.cells_m.min(axis=1) - beside_m, surface.cells_m.max(axis=1) + beside_m
    for top in tops:
        rise_m = surface.height_m - top.height_m
        if not limits.min_rise_m <= rise_m <= limits.max_rise_m:
            continue
        near = top.cells_m[:, ((top.cells_m >= low[:, None]) & (top.cells_m <= high[:, None])).all(axis=0)]
        if any(float(np.hypot(*(surface.cells_m - place[:, None])).min()) <= beside_m for place in near.T):
            return rise_m
    return None


def _why_by_itself(surface: Surface, least_area_m2: float) -> str | None:
    """Return why a surface can be no step whatever is around it, or None."""
    if surface.area_m2 < least_area_m2:
        return f"only {surface.area_m2:.3f} m² large, less than any tread (patches.min_area_m2 is {least_area_m2:g})"
    if lean_deg(surface) > priors.STEEPEST_TREAD_DEG:
        return f"leans by {lean_deg(surface):.0f}°: a ramp or a slanting object, not a tread"
    if narrow_side(surface) < priors.NARROWEST_TREAD_M:
        return f"only {narrow_side(surface) * 1000.0:.0f} mm wide: a railing, a ledge or a beam"
    return None


def plan_keys(surface: Surface, side_m: float) -> Ints:
    """Return one number for each plan cell a surface occupies, the same for all surfaces."""
    return np.unique(cell_keys(surface.cells_m, side_m))


def _distance(surface: Surface, place: Floats) -> float:
    """Return the distance of a place from a surface's nearest cell, metres."""
    plan = float(np.hypot(*(surface.cells_m - place[:2, None])).min())
    return math.hypot(plan, surface.height_m - float(place[2]))


def narrow_side(surface: Surface) -> float:
    """Return the extent of a surface in plan along its lesser axis, metres."""
    shift = surface.cells_m - surface.cells_m.mean(axis=1)[:, None]
    axis = np.linalg.eigh(np.einsum("in,jn->ij", shift, shift))[1][:, 0]
    low, high = np.percentile(axis @ shift, [2.0, 98.0])
    return float(high - low)
