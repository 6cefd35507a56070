"""Every file that the command line writes, kept and compared: ``python -m tests.benchmarks.outputs``.

Before a change that must not alter a result, ``make BEFORE [SCAN ...]``; after it ``make AFTER [SCAN ...]``, then
``compare BEFORE AFTER``. Without a SCAN the sample scans are taken. Of each scan are kept: what ``measure`` and
``check`` print, JSON, CSV, debug PLY, DXF, report as HTML, XLSX and PDF, by both methods. The clock of the reports is
set, so files are compared byte for byte; of JSON the times of the stages are left out, of PDF the pages are compared as
pictures, of XLSX the parts of the archive.
"""

import argparse
import json
import os
import subprocess
import sys
import zipfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pypdfium2

RULES = ("us-ibc-2024", "uk-adk-2013-private")
MADE_AT_S = "1795000000"
"""Seconds since 1970 at which every report says that it was made."""
TIMINGS = "timings_s"
_PAGE_SCALE = 1.0
"""PDF pages are drawn at 72 pixels an inch."""


def make(folder: Path, scans: Sequence[Path]) -> None:
    """Run the commands on every scan and keep what they print and write."""
    folder.mkdir(parents=True, exist_ok=True)
    for scan in scans:
        runs = {
            "survey": ("measure", "--report", "--rules", RULES[0], "--preset", "tls"),
            "paper": ("measure", "--method", "paper"),
            "check": ("check", "--rules", RULES[1], "--report"),
        }
        for name, options in runs.items():
            out = folder / scan.stem / name
            out.mkdir(parents=True, exist_ok=True)
            printed = _run([options[0], str(scan), "-o", str(out), *options[1:]])
            # The folder's own name stands in what is printed.
            (out / "printed.txt").write_text(printed.replace(str(out), "OUT"))
            print(out, flush=True)
    for name, words in {
        "help": ["--help"],
        "rules": ["rules"],
        "presets": ["presets"],
        "quantities": ["quantities"],
    }.items():
        (folder / f"{name}.txt").write_text(_run(words))


def _run(words: Sequence[str]) -> str:
    environment = {**os.environ, "SOURCE_DATE_EPOCH": MADE_AT_S, "COLUMNS": "120"}
    program = "import sys; from stair_inspector.cli import main; sys.exit(main())"
    done = subprocess.run([sys.executable, "-c", program, *words], env=environment, capture_output=True, text=True)
    return f"{done.stdout}\n{done.stderr}\nexit code {done.returncode}\n"


def differences(before: Path, after: Path) -> Iterator[str]:
    """Say, file by file, what differs between two folders that ``make`` wrote."""
    names = sorted({path.relative_to(root) for root in (before, after) for path in root.rglob("*") if path.is_file()})
    for name in names:
        old, new = before / name, after / name
        if not (old.exists() and new.exists()):
            yield f"{name}: only {'before' if old.exists() else 'after'}"
        elif found := _difference(old, new):
            yield f"{name}: {found}"


def _difference(old: Path, new: Path) -> str:
    if old.read_bytes() == new.read_bytes():
        return ""
    match old.suffix:
        case ".json":
            return _first_line(_without_timings(old), _without_timings(new))
        case ".pdf":
            return _pages_differ(old, new)
        case ".xlsx":
            return _parts_differ(old, new)
        case ".ply":
            return "bytes differ"
        case _:
            return _first_line(old.read_text(), new.read_text())


def _without_timings(path: Path) -> str:
    return json.dumps(_stripped(json.loads(path.read_text())), indent=1)


def _stripped(value: object) -> object:
    if isinstance(value, dict):
        return {key: _stripped(each) for key, each in value.items() if key != TIMINGS}
    return [_stripped(each) for each in value] if isinstance(value, list) else value


def _first_line(old: str, new: str) -> str:
    before, after = old.splitlines(), new.splitlines()
    for number, (one, other) in enumerate(zip(before, after, strict=False), start=1):
        if one != other:
            start = next((k for k, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), 0)
            shown = slice(max(0, start - 60), start + 60)
            return f"line {number}: {one[shown]!r} was; {other[shown]!r} is"
    return "" if len(before) == len(after) else f"{len(before)} lines were; {len(after)} are"


def _pages_differ(old: Path, new: Path) -> str:
    before, after = _pages(old), _pages(new)
    if len(before) != len(after):
        return f"{len(before)} pages were; {len(after)} are"
    for number, (one, other) in enumerate(zip(before, after, strict=True), start=1):
        if one.shape != other.shape:
            return f"page {number} has another size"
        if (one != other).any():
            return f"page {number}: {100.0 * np.mean((one != other).any(axis=-1)):.3f} % of its pixels differ"
    return ""


def _pages(path: Path) -> list[np.ndarray]:
    document = pypdfium2.PdfDocument(path)
    try:
        return [page.render(scale=_PAGE_SCALE).to_numpy() for page in document]
    finally:
        document.close()


def _parts_differ(old: Path, new: Path) -> str:
    with zipfile.ZipFile(old) as before, zipfile.ZipFile(new) as after:
        if before.namelist() != after.namelist():
            return "other parts"
        for name in before.namelist():
            if before.read(name) != after.read(name):
                texts = (before.read(name).decode("utf-8", "replace"), after.read(name).decode("utf-8", "replace"))
                # One element a line, or the line that differs would be the whole part.
                return f"{name}: " + _first_line(*(text.replace("><", ">\n<") for text in texts))
    return ""


def main(argv: Sequence[str] | None = None) -> int:
    """Make a folder of outputs, or compare two; 1 where they differ."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.outputs", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    making = commands.add_parser("make", help="write every output into a folder")
    making.add_argument("folder", type=Path)
    making.add_argument("scans", nargs="*", type=Path)
    comparing = commands.add_parser("compare", help="say what differs between two folders")
    comparing.add_argument("before", type=Path)
    comparing.add_argument("after", type=Path)
    args = parser.parse_args(argv)
    if args.command == "make":
        samples = Path(__file__).parents[2] / "sample_scans"
        make(args.folder, args.scans or sorted(samples.glob("*.ply")))
        return 0
    found = list(differences(args.before, args.after))
    print(*(found or ["no difference"]), sep="\n")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
