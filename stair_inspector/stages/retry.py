"""Would other settings find a staircase where these find none? What "Suggest settings" proposes is tried, and said."""

import dataclasses
from dataclasses import dataclass

from stair_inspector import priors
from stair_inspector.errors import CannotMeasure
from stair_inspector.model import HeightOrder, Inspection, Observation
from stair_inspector.params import SETTINGS, Params
from stair_inspector.stages.causes import IF_STEPS
from stair_inspector.stages.flights import find_chains
from stair_inspector.stages.levels import find_height_reach, find_levels, select_horizontal
from stair_inspector.stages.patches import split_levels
from stair_inspector.stages.rejects import Forced
from stair_inspector.stages.sparse import Fitted, follow_spacing
from stair_inspector.stages.suggest import suggest_settings

_ABOUT_SETTINGS = "theta_th"
"""What is advised where no other cause is known speaks of the settings by this name."""
_WORDS = {"horizontal.theta_deg": "theta_th", "levels.eps_m": "eps_z", "levels.min_points": "m"}


@dataclass(frozen=True, slots=True)
class Tried:
    """Settings that were tried where those set found no staircase: names and values that differ, and what they find.

    ``n_risers`` counts the risers of all flights found, 0 for none.
    """

    changes: tuple[tuple[str, float], ...]
    n_risers: int

    @property
    def words(self) -> str:
        """Return the settings as a person says them: ``theta_th 22°, m 20``."""
        return ", ".join(f"{_WORDS[name]} {_shown(name, value)}" for name, value in self.changes)

    @property
    def flags(self) -> str:
        """Return the flags that set them."""
        return " ".join(f"--{name.replace('_', '-')} {value:g}" for name, value in self.changes)


def try_suggested(heights: HeightOrder, is_sparse: bool, params: Params, forced: Forced) -> Tried | None:
    """Look for flights with the settings that are suggested for a scan.

    Parameters
    ----------
    heights : HeightOrder
        All points.
    is_sparse : bool
        Whether m and the plan cell follow the spacing.
    params : Params
        Those that found no staircase.
    forced : Forced
        What the inspector has decided: where that leaves out what there is, no setting is to blame.

    Returns
    -------
    Tried or None
        None where nothing can be suggested, or nothing that was not tried yet.
    """
    if forced.kinds or forced.climb is not None:
        return None
    try:
        suggested = suggest_settings(heights, params).params
        names = [name for name in _WORDS if suggested.value(name) != params.value(name)]
        if not names:
            return None
        horizontal = select_horizontal(heights, suggested.horizontal)
        fitted = Fitted(suggested.levels, suggested.patches)
        if is_sparse:
            fitted = follow_spacing(horizontal, suggested.levels, suggested.patches)
        levels = find_levels(horizontal, find_height_reach(horizontal, suggested.levels.eps_m), fitted.levels)
        patches = split_levels(horizontal, levels, fitted.patches, fitted.levels)
        chains = find_chains(patches, suggested.flights, suggested.patches.min_area_m2, forced).chains
    except CannotMeasure:
        return None
    n_risers = sum(len(chain.steps) for chain in chains)
    # Two risers are furniture more often than a flight: too little to send anybody to other settings.
    is_sure = any(len(chain.steps) >= priors.SURE_RISERS for chain in chains)
    return Tried(tuple((name, suggested.value(name)) for name in names), n_risers if is_sure else 0)


def say_tried(inspection: Inspection, tried: Tried | None, timings_s: dict[str, float]) -> Inspection:
    """Add to an answer of no staircase what was tried beyond the settings, and what that finds.

    That it finds nothing is said only where the answer blames the settings, and not where it knows a better cause.
    ``timings_s`` are those of all stages that ran.
    """
    inspection = dataclasses.replace(inspection, timings_s=dict(timings_s))
    if tried is None:
        return inspection
    if tried.n_risers:
        told = (
            f"but with {tried.words}, as suggested for this scan, {tried.n_risers} risers are found: use {tried.flags}"
        )
    else:
        told = f"{tried.words}, as suggested for this scan, were tried too and find none"
    notes = tuple(
        dataclasses.replace(note, message=f"{_without_limit(note.message) if tried.n_risers else note.message}; {told}")
        if note.code == "no_staircase" and (tried.n_risers or _ABOUT_SETTINGS in note.message.rpartition("; ")[2])
        else note
        for note in inspection.notes
    )
    if not tried.n_risers:
        return dataclasses.replace(inspection, notes=notes)
    message = (
        f"these settings find no staircase; {tried.words}, as suggested for this scan, find {tried.n_risers} risers"
    )
    doubt = Observation("settings_do_not_fit", "doubt", message, cure=tried.flags)
    return dataclasses.replace(inspection, notes=notes, examination=(*inspection.examination, doubt))


def _without_limit(message: str) -> str:
    """Return a cause without the advice to widen a limit: with it, a flight of which treads are missing is measured."""
    return message.partition(f"; {IF_STEPS}")[0]


def _shown(name: str, value: float) -> str:
    return SETTINGS.knob(name).words(value).replace(" °", "°")
