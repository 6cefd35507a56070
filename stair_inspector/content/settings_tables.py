"""The tables of what was set and decided: the settings with their defaults, and the inspector's own decisions."""

from decimal import Decimal
from typing import Any

from stair_inspector.content.document import (
    Cell,
    Column,
    Number,
    Table,
    plain,
)
from stair_inspector.content.records import overrule_records
from stair_inspector.declarations import Knob
from stair_inspector.model import Inspection
from stair_inspector.params import SETTINGS, Params


def overrules_table(inspection: Inspection) -> Table:
    """Return what the inspector decided instead of the program, with reasons, as the JSON lists it."""
    rows: list[tuple[Cell, ...]] = []
    for entry in overrule_records(inspection.params):
        rest = {name: value for name, value in entry.items() if name not in ("what", "kind", "reason")}
        decided = entry.get("kind") or "; ".join(f"{name} {value}" for name, value in rest.items())
        rows.append((plain(entry["what"]), plain(decided), plain(entry.get("reason") or "")))
    columns = (Column("What", width=2.0), Column("Decided", width=2.0), Column("Reason", width=3.0))
    return Table(
        "overrules",
        "What the inspector decided instead of the program",
        columns,
        tuple(rows),
        empty="The inspector overruled nothing: no step was added, taken away or fitted again by hand.",
    )


def settings_table(params: Params) -> Table:
    """Return every setting with its default; those that differ are marked."""
    columns = (
        Column("Setting", width=2.0),
        Column("Meaning", width=2.0),
        Column("Value", digits=0),
        Column("Unit"),
        Column("Default", digits=0),
        Column("Changed"),
    )
    defaults = Params()
    rows: list[tuple[Cell, ...]] = []
    for name, declared in SETTINGS.items():
        knob, value, default = declared.knob, params.value(name), defaults.value(name)
        label = "" if knob is None else f"{knob.title} {knob.symbol}".strip()
        rows.append(
            (
                name,
                label,
                _setting_cell(value, knob),
                "" if knob is None else knob.unit.symbol,
                _setting_cell(default, knob),
                "" if value == default else "changed",
            )
        )
    note = (
        "The numbers of this report are those of these settings: the same scan with the same settings gives them again."
    )
    return Table("settings", "Settings", columns, tuple(rows), note)


def _setting_cell(value: Any, knob: Knob | None) -> Cell:
    if knob is None or isinstance(value, (str, bool)):
        return plain(value) or "(empty)"
    shown = knob.shown(float(value))
    exponent = Decimal(repr(shown)).normalize().as_tuple().exponent
    return Number(shown, max(0, -exponent) if isinstance(exponent, int) else 0)
