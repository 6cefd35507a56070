"""Files that were damaged by chance, and what is asked of reading them: one sentence or a scan, and soon."""

import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from stair_inspector.errors import ReadError
from stair_inspector.files.scans import read_scan

N_DAMAGED = 200


def check_form(path: Path, message: str) -> None:
    """One line: the path, what is wrong; what to do."""
    assert message.startswith(f"{path}: ")
    assert message.isprintable()
    assert len(message) < len(str(path)) + 400
    assert "; " in message


def points_or_none(name: str, content: bytes, **reading: object) -> np.ndarray | None:
    """Read; None for a ReadError of the right form. Anything else fails the test."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        path.write_bytes(content)
        try:
            scan = read_scan(path, **reading)
        except ReadError as error:
            check_form(path, str(error))
            return None
        assert np.isfinite(scan.points).all()
        return scan.points + scan.origin_m


def damaged(content: bytes, rng: np.random.Generator) -> bytes:
    """The content cut, with some bytes changed, left out or put in, by chance."""
    changed = bytearray(content)
    for _ in range(rng.integers(1, 6)):
        at = int(rng.integers(len(changed)))
        kind = rng.integers(3)
        if kind == 0:
            changed[at] = rng.integers(256)
        elif kind == 1:
            del changed[at : at + int(rng.integers(1, 9))]
        else:
            changed[at:at] = rng.bytes(int(rng.integers(1, 9)))
    return bytes(changed[: rng.integers(len(changed))] if rng.random() < 0.2 else changed)


def n_read_of_damaged(
    name: str,
    content: bytes,
    seed: int,
    spoil: Callable[[bytes, np.random.Generator], bytes] = damaged,
    **reading: object,
) -> int:
    """Read 200 damaged files and return of how many points came; each takes less than a second of the processor."""
    rng = np.random.default_rng(seed)
    n_read = 0
    slowest_s = 0.0
    for _ in range(N_DAMAGED):
        changed = spoil(content, rng)
        began = time.process_time()
        n_read += points_or_none(name, changed, **reading) is not None
        slowest_s = max(slowest_s, time.process_time() - began)
    assert slowest_s < 1.0
    return n_read
