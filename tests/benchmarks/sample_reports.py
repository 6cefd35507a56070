"""Two sample reports, of an even stair and of one with a defective step: ``python -m tests.benchmarks.sample_reports``.

Writes all formats of both into a folder, and with ``--pictures`` the pages that the README shows.
"""

import argparse
import io
from datetime import UTC, datetime
from pathlib import Path

from PIL import Image, ImageDraw

from stair_inspector.codes import check
from stair_inspector.content.fields import ReportBasis, ReportFields
from stair_inspector.content.images import read_logo
from stair_inspector.content.readings import TapeReading
from stair_inspector.files.paths import sample_scans
from stair_inspector.files.rule_sets import find_rule_set
from stair_inspector.files.scans import read_scan
from stair_inspector.files.settings import find_preset
from stair_inspector.pipeline import inspect
from stair_inspector.writers.pdf import page_pngs
from stair_inspector.writers.record import write_record
from stair_inspector.writers.report import make_report

MADE_AT = datetime(2026, 11, 22, 12, 0, tzinfo=UTC)
RULES = "us-ibc-2021-dwelling"
READINGS = {
    "straight": (("rise", 1, 0.1700), ("rise", 6, 0.1705), ("going", 4, 0.2795)),
    "defective_step": (("rise", 5, 0.1930), ("rise", 6, 0.1780), ("going", 7, 0.2685)),
}
"""Steel tape readings for each sample scan: quantity, step, metres."""
PAGES = (1, 2, 5)
"""Pages that stand beside each other in the README's picture, from 1."""
_GAP, _GROUND = 14, (214, 219, 224)


def basis_of(name: str) -> ReportBasis:
    """Return what an inspector would have added to the report of a sample scan."""
    fields = ReportFields(
        report_number="S-001" if name == "straight" else "S-002",
        revision="A",
        client="Sample client",
        site="Simulated scan",
        building="Sample building",
        stair="Stair 1",
        level_from="Ground floor",
        level_to="First floor",
        firm="Sample Engineers",
        survey_date="2026-11-20",
        surface="dry",
        purpose="Shows what a report holds",
        instrument_model="Simulated tripod scanner",
        registration_method="simulated, 0.5 mm",
        levelling_source="simulated, 0.05°",
    )
    readings = tuple(
        TapeReading(quantity, value, step=step, u=0.001, instrument="steel tape (made up)")
        for quantity, step, value in READINGS[name]
    )
    return ReportBasis(fields=fields, readings=readings, logo=_logo())


def _logo() -> bytes:
    picture = Image.new("RGBA", (800, 240), (0, 0, 0, 0))
    draw = ImageDraw.Draw(picture)
    for step in range(4):
        draw.rectangle((20 + 52 * step, 170 - 50 * step, 66 + 52 * step, 220), fill=(18, 70, 107, 255))
    stream = io.BytesIO()
    picture.crop((0, 0, 250, 240)).save(stream, "PNG")
    return read_logo(stream.getvalue())


def make(name: str, folder: Path, pictures: Path | None) -> None:
    """Write the report of a sample scan, and its pages for the README."""
    scan = read_scan(sample_scans() / f"{name}.ply")
    inspection = inspect(scan, find_preset("tls").params)
    found = check(inspection, find_rule_set(RULES))
    for path in write_record(scan, inspection, folder, name, MADE_AT, found, basis=basis_of(name), length="full"):
        print(path)
    if pictures is not None:
        pages = page_pngs(make_report(scan, inspection, basis_of(name), MADE_AT, found), 66.0)
        path = pictures / f"report_{name}.png"
        _side_by_side([pages[number - 1] for number in PAGES]).save(path, optimize=True)
        print(path)


def _side_by_side(pages: list[bytes]) -> Image.Image:
    opened = [Image.open(io.BytesIO(page)).convert("RGB") for page in pages]
    width, height = opened[0].size
    size = (len(opened) * (width + _GAP) + _GAP, height + 2 * _GAP)
    sheet = Image.new("RGB", size, _GROUND)
    for k, page in enumerate(opened):
        sheet.paste(page, (_GAP + k * (width + _GAP), _GAP))
    return sheet


def main() -> None:
    """Make both reports."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="where the reports are written")
    parser.add_argument("--pictures", type=Path, help="where the README's pictures are written")
    given = parser.parse_args()
    for name in READINGS:
        make(name, given.folder, given.pictures)


if __name__ == "__main__":
    main()
