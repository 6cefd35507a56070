"""Names of scans in a list: their files' names, told apart by their folders."""

import itertools
from collections.abc import Sequence
from pathlib import Path


def label_scans(scans: Sequence[Path]) -> dict[str, Path]:
    """Return the files by name; where two have the same name, by as much of the path as tells them apart."""
    labels: dict[str, Path] = {}
    for path in scans:
        # A set: a file that was named twice has no twin.
        twins = {other for other in scans if other.name == path.name}
        depth = 1
        while len({other.parts[-depth:] for other in twins}) < len(twins) and depth < len(path.parts):
            depth += 1
        labels["/".join(path.parts[-depth:])] = path
    return labels


def free_label(path: Path, taken: set[str]) -> str:
    """Return a file's name, with as much of its path as makes it a name that is not taken."""
    labels = ["/".join(path.parts[-depth:]) for depth in range(1, len(path.parts) + 1)]
    numbered = (f"{labels[-1]} ({number})" for number in itertools.count(2))
    return next(label for label in itertools.chain(labels, numbered) if label not in taken)
