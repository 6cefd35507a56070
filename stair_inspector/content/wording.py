"""The sentences of a report. It says within or outside the limit of a clause; it never passes a legal judgement."""

from collections.abc import Sequence

from stair_inspector.codes.findings import Check, Finding, Verdict, gravest
from stair_inspector.codes.limits import Limit
from stair_inspector.codes.phrases import gap_text, in_place_of, limit_words, value_text
from stair_inspector.codes.rules import Side
from stair_inspector.content.cells import numbers_of, outside_counts
from stair_inspector.content.document import Status, plain
from stair_inspector.content.note_words import note_sentence
from stair_inspector.content.uncertainty_words import doubtful_sentences
from stair_inspector.content.verdicts import verdict_sentence
from stair_inspector.model import Inspection

_MOST_CHANGES = 4
"""So many changed limits are named on the first page."""

DEFINITIONS = (
    "Rise: vertical, from the nosing below (or the floor or landing before the lowest riser) to this step's nosing.",
    "Going: horizontal, square to the nosing, from this nosing to the next; US codes call it tread depth.",
    "Tread depth: from the nosing to the face of the riser above, or to the tread's back edge.",
    "Overhang: tread depth less going, square to the nosing above.",
    "Width: between the side edges of the tread; not the clear width between handrails or walls.",
    "Pitch: angle of the line from this nosing to the next; of a flight, of the line fitted to all its nosings.",
    "2R + G: twice the rise to a step and its going.",
)


def verdict_of(check: Check) -> Status:
    """Return the result of a whole check in a few words; it is good only where nothing is left to look at."""
    judged = [found for found in check.findings if found.rule.severity == "limit"]
    verdicts = {found.verdict for found in judged}
    changed = _changed_words(check)
    if Verdict.OUTSIDE in verdicts:
        return Status("; ".join(["values outside limits", *changed]), "bad")
    if Verdict.OUTSIDE_CLOSE in verdicts:
        return Status("; ".join(["values outside limits, by less than U", *changed]), "close")
    left = [*_left_to_look_at(check), *changed]
    if not verdicts & {Verdict.WITHIN, Verdict.WITHIN_CLOSE}:
        is_beyond = any(found.is_reported_beyond for found in check.findings)
        return Status("; ".join(["nothing could be judged", *left]), "close" if is_beyond else "plain")
    # A rule that does not apply to a step leaves nothing open.
    is_open = any(found.is_open for found in judged)
    words = "what was measured is within; not all was" if is_open else "measured values within limits"
    return Status("; ".join([words, *left]), "close" if is_open or left else "good")


def _left_to_look_at(check: Check) -> list[str]:
    """Return what keeps a check without a value outside a limit from being simply good."""
    left = []
    near = sum(found.verdict is Verdict.WITHIN_CLOSE and found.rule.severity == "limit" for found in check.findings)
    if near:
        left.append(f"{near} nearer to a limit than U")
    if any(found.verdict.is_outside and found.rule.severity == "advisory" for found in check.findings):
        left.append("values outside what is advised")
    if any(found.is_reported_beyond for found in check.findings):
        left.append("values beyond a number that is reported only are for the inspector to judge")
    has_value = {found.rule.rule_id for found in check.findings if found.value is not None}
    without = [rule for rule in check.rule_set.rules if rule.rule_id in has_value and not rule.has_number]
    if without:
        spreads = all(rule.statistic in ("flight_range", "adjacent_difference") for rule in without)
        left.append(f"{'uniformity' if spreads else 'what has no number'} is for the inspector to judge")
    return left


def _changed_words(check: Check) -> list[str]:
    count = check.rule_set.n_changed
    return [f"{count} limit{'' if count == 1 else 's'} changed by the user"] if count else []


def changed_limits_sentence(check: Check) -> str:
    """Return which limits are not those of the rule file, for the first page; empty where all are."""
    rules = check.rule_set
    changes: list[str] = []
    for rule in rules.rules:
        sides: tuple[tuple[Side, Limit | None], ...] = (("minimum", rule.minimum), ("maximum", rule.maximum))
        for side, limit in sides:
            edit = rules.edit_of(rule.rule_id, side)
            if edit is not None:
                changes.append(
                    f"{plain(rule.term)}, {side} {limit_words(limit)} {plain(in_place_of(edit))} ({plain(rule.clause)})"
                )
    if not changes:
        return ""
    more = len(changes) - _MOST_CHANGES
    told = "; ".join(changes[:_MOST_CHANGES]) + (f"; and {more} more" if more > 0 else "")
    is_one = len(changes) == 1
    return (
        f"{'This limit is' if is_one else 'These limits are'} the user's and not the code's: {told}. The reason"
        f"{' stands' if is_one else 's stand'} under 'Limits edited by the user'."
    )


def code_words(check: Check) -> str:
    """Return what was applied: the set's name, edition and variant, and whether its limits are all its own."""
    return "; ".join([plain(check.rule_set.title), *_changed_words(check)])


def result_sentence(inspection: Inspection, check: Check | None) -> str:
    """Return what the report says first."""
    stair = _stair_words(inspection)
    if not inspection.steps:
        reason = next((note.message for note in inspection.notes if note.code == "no_staircase"), "no staircase found")
        return note_sentence(reason)
    if inspection.is_withheld:
        asked = " ".join(note_sentence(found.message) for found in inspection.questions)
        what = "no value is given" if check is None else "no value is given and nothing was judged"
        return f"{stair} A question about the scan has to be answered first; {what}. {asked}"
    if check is None:
        return f"{stair} This report states measurements; no rule set was applied."
    return f"{stair} {plain(verdict_sentence(check))}"


def outside_sentences(check: Check) -> tuple[str, ...]:
    """Return one sentence for every rule and flight with a value outside its limit: the gravest."""
    sentences = []
    for rule in check.rule_set.rules:
        outside = [found for found in check.of_rule(rule.rule_id) if found.verdict.is_outside]
        for flight in dict.fromkeys(found.flight for found in outside):
            here = tuple(found for found in outside if found.flight == flight)
            sentences.append(_outside_sentence(check, gravest(here), here))
    return tuple(sentences)


def _outside_sentence(check: Check, found: Finding, alike: Sequence[Finding]) -> str:
    rule = found.rule
    beyond = gap_text(rule, abs(found.margin or 0.0))
    place = f"flight {found.flight}" if found.flight is not None else "the stair"
    steps = ""
    if found.steps:
        steps = f", {'step' if len(found.steps) == 1 else 'steps'} {numbers_of(found.steps)}"
    limit = plain(found.limit.text) if found.limit is not None else "no number"
    edit = check.edit_behind(found)
    # A limit that the user has set is listed in no code.
    origin = "listed in" if edit is None else f"set by the user {plain(in_place_of(edit))},"
    close = ", by less than U" if found.verdict is Verdict.OUTSIDE_CLOSE else ""
    more = f"; of this rule {outside_counts(alike)}, this is the gravest" if len(alike) > 1 else ""
    kind = "advisory limit" if rule.severity == "advisory" else "limit"
    return (
        f"{place[:1].upper()}{place[1:]}{steps}: {plain(rule.term)} is {value_text(found)}, outside the {kind} "
        f"{limit} {origin} {plain(rule.clause)}, {_edition_words(check)}, by {beyond}{close}{more}."
    )


def _edition_words(check: Check) -> str:
    rules = check.rule_set
    overlays = " or its overlay" if rules.overlays else ""
    return f"{plain(rules.name)}, {plain(rules.edition)}{overlays}"


def limitation_sentences(inspection: Inspection, check: Check | None) -> tuple[str, ...]:
    """Return what the report does not say, as far as the program knows."""
    sentences = ["The report describes the surfaces that the scan shows, as they were on the day of the scan."]
    if inspection.flights and not inspection.is_withheld:
        sentences += [
            "Width is that of the treads between their side edges; the clear width between handrails or walls was not "
            "measured.",
            "Rise and going are those of the nosings on three lines across the tread; between the lines they were not "
            "evaluated.",
        ]
    if inspection.params.method == "paper":
        sentences.append(
            "The scan was measured by the paper's method: rise, going and width from nosing to nosing were not "
            "measured, and no limit of a code applies to its values."
        )
    sentences += doubtful_sentences(inspection)
    sentences += [
        f"Flight {flight.flight_id} goes on: {flight.goes_on}. Nothing is reported of those."
        for flight in inspection.flights
        if flight.goes_on is not None
    ]
    curved = [flight for flight in inspection.flights if flight.shape == "curved"]
    if curved:
        sentences.append(
            f"Flight {numbers_of(flight.flight_id for flight in curved)} curves. Its goings are those along the arc "
            "through the middles of its nosings, and on the left and right along arcs about the same centre. Codes "
            "limit the size of a going on a walking line of their own, and no such limit was judged there."
        )
    winding = [flight for flight in inspection.flights if flight.shape in ("winder", "spiral")]
    if winding and not inspection.is_withheld:
        numbers = numbers_of(flight.flight_id for flight in winding)
        sentences.append(
            f"Flight {numbers} winds. Its steps are measured about their own nosings; codes measure on a walking line, "
            "and no limit was judged there."
        )
    unseen = [step.step_id for step in inspection.steps if step.rise_m is None]
    if unseen and inspection.params.method == "survey" and not inspection.is_withheld:
        sentences.append(f"Rise not measured: step {numbers_of(unseen)}. It may differ from the others.")
    if inspection.params.overrules.region.strip():
        sentences.append("Only the points in the region of interest were measured; appendix A gives its corners.")
    if check is not None:
        changed = check.rule_set.n_changed
        but = f", but for {changed} that the user has changed and that this report lists" if changed else ""
        sentences.append(
            f"Limits are those of the rule file named above{but}; cities and states amend codes. Whether a limit "
            "applies to this stair is for the inspector to decide."
        )
    return tuple(sentences)


def _stair_words(inspection: Inspection) -> str:
    n_steps, n_flights = len(inspection.steps), len(inspection.flights)
    steps = f"{n_steps} step{'' if n_steps == 1 else 's'}"
    if not n_flights:
        return f"{steps} found."
    risers = sum(flight.n_risers for flight in inspection.flights)
    beyond = "".join(
        f" Flight {flight.flight_id} goes on: {flight.goes_on}."
        for flight in inspection.flights
        if flight.goes_on is not None
    )
    return (
        f"{n_flights} flight{'' if n_flights == 1 else 's'} with {risers} riser{'' if risers == 1 else 's'} found"
        f"{'' if inspection.is_withheld else ' and measured'}.{beyond}"
    )
