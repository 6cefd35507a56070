"""``stair-inspector verify``: whether the results in a folder belong together, and what was changed since."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro
from typing_extensions import Doc

from stair_inspector.cli.arguments import Debug, parse_arguments
from stair_inspector.cli.output import report_error, say
from stair_inspector.errors import StairError

_MOST_NAMED, _LONGEST_NAME = 20, 255


@dataclass(frozen=True)
class VerifyRecords:
    """Hold the results in a folder against their manifests: exit code 1 where they do not belong together.

    A manifest holds the SHA-256 of every file of a run, of its scan and of its rules. It shows what was changed by
    mistake or is of another run; it is no signature.
    """

    folder: Annotated[
        tyro.conf.Positional[Path], tyro.conf.arg(metavar="DIR"), Doc("Folder that measure, check or compare wrote.")
    ] = tyro.MISSING
    scan: Annotated[
        tyro.conf.UseAppendAction[tuple[Path, ...]],
        tyro.conf.arg(metavar="SCAN"),
        Doc("Tell too which record is of this scan; may be given again."),
    ] = ()
    debug: Debug = False


def run(args: list[str]) -> int:
    """Verify every record of a folder; return the exit code: 1 where files do not belong together."""
    options = parse_arguments(VerifyRecords, "verify", args, VerifyRecords())
    from stair_inspector.files.manifests import find_manifests, hash_scan, verify
    from stair_inspector.files.raw_cloud import excerpt

    worst = 0
    hashes: dict[str, list[str]] = {}
    for path in find_manifests(options.folder):
        try:
            found = verify(path)
        except StairError as error:
            worst = max(worst, report_error(error))
            continue
        stem = found.manifest.stem
        for _, sha256 in found.manifest.scans:
            hashes.setdefault(sha256, []).append(stem)
        told = [
            f"{words} {', '.join(excerpt(name, _LONGEST_NAME) for name in names[:_MOST_NAMED])}"
            f"{f' and {len(names) - _MOST_NAMED} more' if len(names) > _MOST_NAMED else ''}"
            for words, names in (
                ("changed since:", found.changed),
                ("missing:", found.missing),
                ("of another run:", found.strays),
            )
            if names
        ]
        scans = " and ".join(name for name, _ in found.manifest.scans)
        count = len(found.manifest.files)
        words = (
            f"{count} files of {scans} belong together" if not told else f"do not belong together; {'; '.join(told)}"
        )
        say(f"{stem}: {words} (stair_inspector {found.manifest.version}, {found.manifest.made_at})")
        worst = max(worst, int(not found.belongs_together))
    for scan in options.scan:
        stems = hashes.get(hash_scan(scan), [])
        say(f"{scan}: {'measured in ' + ', '.join(stems) if stems else 'is no scan of these results'}")
        worst = max(worst, int(not stems))
    return worst
