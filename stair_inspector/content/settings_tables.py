"""The tables of what was set and decided: the settings with their defaults, and the inspector's own decisions."""

from decimal import Decimal
from typing import Any

from stair_inspector.content.document import Cell, Column, Number, Table, plain, table_of
from stair_inspector.content.records import overrule_records
from stair_inspector.declarations import Knob
from stair_inspector.model import Inspection
from stair_inspector.params import SETTINGS, Params


def overrules_table(inspection: Inspection) -> Table:
    """Return what the inspector decided instead of the program, with reasons, as the JSON lists it."""

    def rest(entry: dict[str, Any]) -> str:
        return "; ".join(f"{name} {entry[name]}" for name in entry if name not in ("what", "kind", "reason"))

    return table_of(
        "overrules",
        "What the inspector decided instead of the program",
        overrule_records(inspection.params),
        (Column("What", width=2.0), lambda entry: plain(entry["what"])),
        (Column("Decided", width=2.0), lambda entry: plain(entry.get("kind") or rest(entry))),
        (Column("Reason", width=3.0), lambda entry: plain(entry.get("reason") or "")),
        empty="The inspector overruled nothing: no step was added, taken away or fitted again by hand.",
    )


def settings_table(params: Params) -> Table:
    """Return every setting with its default; those that differ are marked."""
    defaults = Params()

    def label(knob: Knob | None) -> str:
        if knob is None or not knob.symbol:
            return "" if knob is None else knob.title
        # "vertical reach ε_z", but "front edge, paper's α_f".
        return f"{knob.title}{',' if ' ' in knob.symbol else ''} {knob.symbol}"

    return table_of(
        "settings",
        "Settings",
        [(name, declared.knob, params.value(name), defaults.value(name)) for name, declared in SETTINGS.items()],
        (Column("Setting", width=2.0), lambda each: each[0]),
        (Column("Meaning", width=2.0), lambda each: label(each[1])),
        (Column("Value", digits=0), lambda each: _setting_cell(each[2], each[1])),
        (Column("Unit"), lambda each: "" if each[1] is None else each[1].unit.symbol),
        (Column("Default", digits=0), lambda each: _setting_cell(each[3], each[1])),
        (Column("Changed"), lambda each: "" if each[2] == each[3] else "changed"),
        note=(
            "The numbers of this report are those of these settings: the same scan with the same settings gives them "
            "again."
        ),
    )


def _setting_cell(value: Any, knob: Knob | None) -> Cell:
    if knob is None or isinstance(value, (str, bool)):
        return plain(value) or "(empty)"
    shown = knob.shown(float(value))
    exponent = Decimal(repr(shown)).normalize().as_tuple().exponent
    return Number(shown, max(0, -exponent) if isinstance(exponent, int) else 0)
