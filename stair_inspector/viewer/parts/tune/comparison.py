"""Two results of one scan side by side: which steps are the same, and by how much their values differ."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stair_inspector.errors import ConfigError
from stair_inspector.geometry.arrays import Ints
from stair_inspector.model import Inspection, Statistics, Step
from stair_inspector.params import SETTINGS, Params
from stair_inspector.quantities import COMPARED, IN_TABLE, SHOWN_OF_PAPER, is_si_unit, with_above
from stair_inspector.units import NOT_KNOWN, ShownUnit, Unit, number_text, shown_in, signed_text, uncertainty_text
from stair_inspector.viewer.bridge.controls import value_words
from stair_inspector.viewer.bridge.markup import DIM, LINE, hint_of, table_head, text

_LEAST_SHARE = 0.1
"""Two steps are the same one when they share at least this part of the smaller one's points."""
_SURVEY = {each.column: (each.head, hint_of(each)) for each in IN_TABLE}
_PAPER = {each.column: (each.symbol, hint_of(each)) for each in SHOWN_OF_PAPER}
_N_MEANS = 2
"""Of so many quantities, the first of the columns, the summary has the mean."""
_SUMMARY = {
    "steps": "Steps",
    "flights": "Flights",
    **{f"mean_{name}": f"Mean {head}" for name, (head, _) in {**_SURVEY, **_PAPER}.items()},
    **{f"max_adjacent_{each.column}": f"Largest step to step, {each.label}" for each in COMPARED},
}
_CELL = "text-align:right;padding:2px 4px;white-space:nowrap"


@dataclass(frozen=True, slots=True)
class Difference:
    """A quantity in both results, metres or degrees as its name ends; None where it is not known.

    ``u_a`` and ``u_b`` are the expanded uncertainties (k = 2), None with the paper's method.
    """

    name: str
    a: float | None
    b: float | None
    u_a: float | None = None
    u_b: float | None = None

    @property
    def difference(self) -> float | None:
        """``b`` less ``a``; None unless both are known."""
        return None if self.a is None or self.b is None else self.b - self.a

    @property
    def is_beyond_u(self) -> bool:
        """Whether the difference is larger than both uncertainties together: the settings matter here."""
        if self.difference is None or self.u_a is None or self.u_b is None:
            return False
        return abs(self.difference) > math.hypot(self.u_a, self.u_b)


@dataclass(frozen=True, slots=True)
class ComparedStep:
    """One step by its number in each result, None where it has none there; ``values`` in the order of the columns."""

    step_a: int | None
    step_b: int | None
    values: tuple[Difference, ...]


@dataclass(frozen=True, slots=True)
class Comparison:
    """Result B against result A of the same scan.

    ``is_survey`` says which quantities the ``steps`` hold: the survey's, or the paper's where either result is the
    paper's. ``settings`` are those that differ: dotted name, value in A, value in B. ``summary`` holds the number of
    steps and flights, the means over all steps, and the largest differences between neighbours.
    """

    is_survey: bool
    steps: tuple[ComparedStep, ...]
    summary: tuple[Difference, ...]
    settings: tuple[tuple[str, object, object], ...]


def compare(a: Inspection, b: Inspection) -> Comparison:
    """Compare two results step by step.

    Steps are the same where they share their points: each is the other's largest share. Numbers change with the
    settings, points do not.

    Parameters
    ----------
    a, b : Inspection
        Of the same file.

    Raises
    ------
    ConfigError
        They are of different scans.
    """
    if a.scan.sha256 != b.scan.sha256 or len(a.labels) != len(b.labels):
        raise ConfigError(f"compare: {a.scan.name} and {b.scan.name} are different scans; choose a run of this scan")
    is_survey = "paper" not in (a.params.method, b.params.method)
    names = tuple(_SURVEY if is_survey else _PAPER)
    steps_a, steps_b = ({pair[0].step_id: pair for pair in with_above(each.steps)} for each in (a, b))
    rows = []
    for step_a, step_b in _in_order(list(steps_a), list(steps_b), _same_steps(a, b)):
        first, second = (
            _values(steps.get(number or 0), is_survey=is_survey)
            for steps, number in ((steps_a, step_a), (steps_b, step_b))
        )
        pairs = zip(names, first, second, strict=True)
        rows.append(ComparedStep(step_a, step_b, tuple(Difference(n, x, y, u, v) for n, (x, u), (y, v) in pairs)))
    return Comparison(is_survey, tuple(rows), _summary(a, b, names, rows), _changed(a.params, b.params))


def comparison_html(comparison: Comparison, name_a: str, name_b: str, unit: Unit = "mm") -> str:
    """Return the comparison as tables: the settings that differ, the result as a whole, then a row for each step.

    Every cell of a step holds A's value, B's value and, in bold, B less A. A difference beyond both uncertainties has a
    mark and says so; colour is not the only sign.

    Parameters
    ----------
    comparison : Comparison
        From :func:`compare`.
    name_a, name_b : str
        What the two results are called.
    unit : str
        For lengths.
    """
    columns = _SURVEY if comparison.is_survey else _PAPER
    head = table_head(
        (
            ("#", "", f"Step in {name_a} → in {name_b}"),
            *((title, _shown(name, unit) or "", hint) for name, (title, hint) in columns.items()),
        ),
        left=("#",),
    )
    rows = "".join(_step_row(step, unit) for step in comparison.steps)
    return (
        '<div data-testid="comparison" class="si-results" style="font-size:11.5px;line-height:1.3;padding:0 9px 6px">'
        f'<div style="padding:4px 0"><b>A:</b> {text(name_a)} · <b>B:</b> {text(name_b)} '
        f'<span style="color:{DIM}">· in each cell A, B and <b>B − A</b>; ! is beyond both uncertainties</span></div>'
        f"{_settings_html(comparison)}{_summary_html(comparison, unit)}"
        '<table data-testid="comparison-table" style="border-collapse:collapse;width:100%;'
        f'font-variant-numeric:tabular-nums">{head}<tbody>{rows}</tbody></table></div>'
    )


def _same_steps(a: Inspection, b: Inspection) -> dict[int, int]:
    """Return for steps of A the step of B that shares most of its points, where that holds the other way round too."""
    ids_a, ids_b = ([step.step_id for step in each.steps] for each in (a, b))
    if not ids_a or not ids_b:
        return {}
    n_a, n_b = max(ids_a) + 1, max(ids_b) + 1
    is_step = np.isin(a.labels, ids_a) & np.isin(b.labels, ids_b)
    keys = a.labels[is_step].astype(np.int64) * n_b + b.labels[is_step]
    shared: Ints = np.bincount(keys, minlength=n_a * n_b).reshape(n_a, n_b)
    size_a, size_b = (np.bincount(each.labels[each.labels > 0].astype(np.int64)) for each in (a, b))
    same = {}
    for step_a in ids_a:
        step_b = int(np.argmax(shared[step_a]))
        n_shared = int(shared[step_a, step_b])
        is_mutual = int(np.argmax(shared[:, step_b])) == step_a
        if is_mutual and n_shared > 0 and n_shared >= _LEAST_SHARE * min(size_a[step_a], size_b[step_b]):
            same[step_a] = step_b
    return same


def _in_order(ids_a: Sequence[int], ids_b: Sequence[int], same: dict[int, int]) -> list[tuple[int | None, int | None]]:
    """Return pairs of steps from bottom to top; one that only B has stands below the next that both have."""
    rest = [step_b for step_b in ids_b if step_b not in same.values()]
    pairs: list[tuple[int | None, int | None]] = []
    for step_a in ids_a:
        step_b = same.get(step_a)
        while step_b is not None and rest and rest[0] < step_b:
            pairs.append((None, rest.pop(0)))
        pairs.append((step_a, step_b))
    return pairs + [(None, step_b) for step_b in rest]


def _values(found: tuple[Step, Step | None] | None, *, is_survey: bool) -> list[tuple[float | None, float | None]]:
    """Return value and uncertainty of each quantity of a step, given with the one above it."""
    if found is None:
        return [(None, None)] * len(_SURVEY if is_survey else _PAPER)
    step, above = found
    if not is_survey:
        return [(quantity.of_paper(step.paper), None) for quantity in SHOWN_OF_PAPER]
    measured = [quantity.of(step, above) for quantity in IN_TABLE]
    return [(None, None) if each is None else (each.value, each.u) for each in measured]


def _summary(
    a: Inspection, b: Inspection, names: Sequence[str], rows: Sequence[ComparedStep]
) -> tuple[Difference, ...]:
    counts = [Difference("steps", len(a.steps), len(b.steps))]
    if names[0] in _SURVEY:
        counts.append(Difference("flights", len(a.flights), len(b.flights)))
    means = [
        Difference(f"mean_{name}", _mean([row.values[k].a for row in rows]), _mean([row.values[k].b for row in rows]))
        for k, name in enumerate(names[:_N_MEANS])
    ]
    worst = [
        Difference(
            f"max_adjacent_{quantity.column}",
            *(_worst([quantity.statistics_of(flight) for flight in each.flights]) for each in (a, b)),
        )
        for quantity in COMPARED
    ]
    return (*counts, *means, *(worst if names[0] in _SURVEY else ()))


def _mean(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return float(np.mean(known)) if known else None


def _worst(statistics: Sequence[Statistics | None]) -> float | None:
    known = [each.max_adjacent for each in statistics if each is not None and each.max_adjacent is not None]
    return max(known, default=None)


def _changed(a: Params, b: Params) -> tuple[tuple[str, object, object], ...]:
    pairs = ((name, a.value(name), b.value(name)) for name in SETTINGS)
    return tuple((name, before, after) for name, before, after in pairs if before != after)


def _settings_html(comparison: Comparison) -> str:
    if not comparison.settings:
        return (
            f'<div data-testid="compared-settings" style="color:{DIM};padding:2px 0">The settings are the same.</div>'
        )
    rows = "".join(
        f'<li data-setting="{text(name)}">{text(SETTINGS.setting(name).called)}: {text(value_words(name, before))} → '
        f"{text(value_words(name, after))}</li>"
        for name, before, after in comparison.settings
    )
    return f'<ul data-testid="compared-settings" style="margin:2px 0;padding-left:16px">{rows}</ul>'


def _summary_html(comparison: Comparison, unit: Unit) -> str:
    rows = "".join(
        f'<tr data-quantity="{each.name}"><td style="color:{DIM};padding:1px 8px 1px 0">{_SUMMARY[each.name]}</td>'
        f'<td style="{_CELL}">{_number(each.name, each.a, unit)}</td><td style="{_CELL}">'
        f'{_number(each.name, each.b, unit)}</td><td style="{_CELL};font-weight:600">{_signed(each, unit)}</td>'
        f'<td style="color:{DIM}">{_shown(each.name, unit) or ""}</td></tr>'
        for each in comparison.summary
    )
    return (
        '<table data-testid="comparison-summary" style="border-collapse:collapse;margin:2px 0 6px;'
        f'font-variant-numeric:tabular-nums"><tbody>{rows}</tbody></table>'
    )


def _step_row(step: ComparedStep, unit: Unit) -> str:
    one, other = (NOT_KNOWN if number is None else str(number) for number in (step.step_a, step.step_b))
    words = f"{one} → {other}" if one != other else one
    cells = "".join(_step_cell(value, unit) for value in step.values)
    return (
        f'<tr data-testid="comparison-row" data-a="{step.step_a or ""}" data-b="{step.step_b or ""}" '
        f'style="border-bottom:1px solid {LINE}"><td style="{_CELL};text-align:left;vertical-align:top">{words}</td>'
        f"{cells}</tr>"
    )


def _step_cell(value: Difference, unit: Unit) -> str:
    shown = _shown(value.name, unit)
    hint = ""
    mark = ""
    if value.u_a is not None and value.u_b is not None and shown is not None:
        u = uncertainty_text(math.hypot(value.u_a, value.u_b), shown)
        told = _signed(value, unit)
        hint = f"B − A {told} {shown}, " if told else ""
        hint += f"the two uncertainties together {u} {shown}"
        mark = '<span style="color:#e8590c">! </span>' if value.is_beyond_u else ""
    return (
        f'<td data-quantity="{value.name}" title="{text(hint)}" style="{_CELL}">'
        f'<div style="color:{DIM}">{_number(value.name, value.a, unit)}</div>'
        f"<div>{_number(value.name, value.b, unit)}</div>"
        f'<div data-testid="difference" style="font-weight:600">{mark}{_signed(value, unit)}</div></td>'
    )


def _shown(name: str, unit: Unit) -> ShownUnit | None:
    """Return the unit a quantity is shown in, None for a count."""
    si_unit = name.rpartition("_")[2]
    return shown_in(si_unit, unit) if is_si_unit(si_unit) else None


def _number(name: str, value: float | None, unit: Unit) -> str:
    shown = _shown(name, unit)
    if shown is None:
        return NOT_KNOWN if value is None else f"{value:g}"
    return number_text(value, shown)


def _signed(value: Difference, unit: Unit) -> str:
    """Return B less A with its sign, nothing where they are the same."""
    return NOT_KNOWN if value.difference is None else signed_text(value.difference, _shown(value.name, unit))
