"""Who and what a report is of: the user's fields by their groups, the instrument, and the scan itself."""

import dataclasses

from stair_inspector import __version__
from stair_inspector.codes.findings import Check
from stair_inspector.content import wording
from stair_inspector.content.document import Block, Column, Facts, plain
from stair_inspector.content.fields import FIELD_GROUPS, ReportBasis, ReportFields
from stair_inspector.model import Inspection
from stair_inspector.units import tidy


def identification_blocks(basis: ReportBasis, check: Check | None) -> list[Block]:
    """Return the fields of the report, with the rule set that was applied."""
    groups = ("Report", "Object", "Survey", "Conditions", "Commission")
    blocks: list[Block] = [_facts(group, basis.fields) for group in groups]
    code = "no rule set was applied" if check is None else wording.code_words(check)
    last = blocks[-1]
    assert isinstance(last, Facts)
    blocks[-1] = dataclasses.replace(last, items=(*last.items[:-1], ("Reference code", code), last.items[-1]))
    return blocks


def _facts(group: str, fields: ReportFields) -> Facts:
    """Return a group of the user's fields; what needs room has a line of its own."""
    names = FIELD_GROUPS[group]
    items = tuple((ReportFields.label_of(name), plain(getattr(fields, name))) for name in names)
    return Facts(group.lower().replace("-", "_"), group, items)


def instrument_blocks(inspection: Inspection, basis: ReportBasis, results: str = "") -> list[Block]:
    """Return what the stair was scanned with, the scan, and the results that belong to the report."""
    scan, up = inspection.scan, inspection.up
    vector = ", ".join(f"{tidy(component, 6):.6f}" for component in up.vector)
    source = {"given": "given by the user", "floor": "normal of the floor", "treads": "normal of the treads"}[up.source]
    origin = ", ".join(f"{tidy(coordinate, 3):.3f}" for coordinate in scan.origin_m)
    count = Column("", digits=0)
    items = (
        ("Scan file", plain(scan.name)),
        ("SHA-256", plain(scan.sha256)),
        ("Points in the file", count.text(scan.n_points)),
        ("Points used", count.text(scan.n_used)),
        ("Unit of the file", plain(scan.unit)),
        ("Origin taken off", f"{origin} m"),
        ("Up vector", f"{vector} ({source})"),
        ("U of the vertical", "not stated" if up.u_deg is None else f"{tidy(up.u_deg, 3):.3f}° (k = 2)"),
        ("Method", "survey, nosing to nosing" if inspection.params.method == "survey" else "paper (Joo et al.)"),
        ("Software", f"stair_inspector {__version__}"),
        *((("Results", plain(results)),) if results else ()),
    )
    return [
        _facts("Instrument", basis.fields),
        _facts("Scanning", basis.fields),
        Facts("scan", "Scan", items, columns=1),
    ]
