"""A process of its own for the library that reads E57: a crash of it is one sentence.

The process reads a copy of the file, which has no name in any folder where the system allows that: nothing is left
behind, however either process ends. It is told one order a line, as JSON, and answers with lines of JSON; the points of
a block follow their line as they lie in memory.
"""

import json
import os
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from stair_inspector.errors import ReadError
from stair_inspector.files.e57_child import CPU_BYTES_PER_S
from stair_inspector.files.raw_cloud import TRUNCATED_HINT, excerpt
from stair_inspector.files.raw_stations import NAME_CHARACTERS
from stair_inspector.geometry.arrays import Colors, Floats

_MOST_LINE_BYTES = 1 << 20
COMMAND = [sys.executable, "-P", "-m", "stair_inspector.files.e57_child"]
"""Without -P a file json.py in the working folder, beside somebody's scans, would be run."""
PATIENCE_S = 60.0
"""What the process may wait for the machine, beyond the time of its own that it may take."""


@dataclass(frozen=True, slots=True, eq=False)
class E57Station:
    """What an E57 says of a scan: ``place`` (3,) of the scanner and ``steps`` (3,) of the coordinates, or None.

    ``refused`` is why it cannot be read, nothing where it can.
    """

    name: str
    count: int
    place: Floats | None
    steps: Floats | None
    has_colors: bool
    has_unknown_colors: bool
    has_intensities: bool
    refused: str


@dataclass(frozen=True, slots=True, eq=False)
class E57Block:
    """Points (n, 3) of a station in the file's frame, their colours or None, and how many invalid ones it had.

    ``intensities`` (n,) as the file has them, or None.
    """

    station: int
    points: Floats
    colors: Colors | None
    n_invalid: int
    intensities: Floats | None


class E57Process:
    """Reads one E57 after the other in a process of its own; a new one is started after a crash.

    A context manager: with its end the process and its copy of the file are gone.
    """

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._file: IO[bytes] | None = None
        self._path = ""
        self._n_bytes = 0
        self._stations: list[E57Station] = []

    def __enter__(self) -> "E57Process":
        return self

    def __exit__(self, *_: object) -> None:
        self._end()
        if self._file is not None:
            self._file.close()
            if os.name != "posix":
                with suppress(OSError):
                    Path(self._path).unlink()

    @property
    def process_id(self) -> int | None:
        """The number of the process while there is one."""
        return None if self._process is None else self._process.pid

    def open(self, data: bytes) -> list[E57Station]:
        """Return the stations of a file.

        Parameters
        ----------
        data : bytes
            The whole file.

        Raises
        ------
        ReadError
            The file is damaged, or the library ended, ran on or filled the memory over it.
        """
        self._n_bytes = len(data)
        self._keep(data)
        if self._process is None:
            self._start()
        answer = self._ask(order="open", path=self._path, n_bytes=len(data))
        self._stations = [
            E57Station(
                excerpt(told["name"], NAME_CHARACTERS),
                told["count"],
                None if told["place"] is None else np.array(told["place"]),
                None if told["steps"] is None else np.array(told["steps"]),
                told["has_colors"],
                told["colors_unknown"],
                told["has_intensities"],
                told["refused"],
            )
            for told in answer["stations"]
        ]
        return self._stations

    def read(self, stations: list[int]) -> Iterator[E57Block]:
        """Yield the points of stations of the file that was opened, by their places in it.

        Raises
        ------
        ReadError
            As :meth:`open`.
        """
        answer = self._ask(order="read", stations=stations)
        while answer["kind"] == "block":
            n, number = answer["n"], answer["station"]
            points = self._array((n, 3), np.float64)
            colors = self._array((n, 3), np.uint8) if self._stations[number].has_colors else None
            shine = self._array((n, 1), np.float64)[:, 0] if self._stations[number].has_intensities else None
            yield E57Block(number, points, colors, answer["n_invalid"], shine)
            answer = self._answer()

    def _keep(self, data: bytes) -> None:
        """Write the file where the process finds it."""
        try:
            if self._file is None:
                if os.name == "posix":
                    self._file = tempfile.TemporaryFile()  # noqa: SIM115 - it is open as long as the process
                    self._path = f"/dev/fd/{self._file.fileno()}"
                else:
                    self._file = tempfile.NamedTemporaryFile(delete=False)  # noqa: SIM115 - as above
                    self._path = self._file.name
            self._file.seek(0)
            self._file.truncate()
            self._file.write(data)
            self._file.flush()
        except OSError as error:
            reason = excerpt(error.strerror or "no reason given")
            raise ReadError(
                f"cannot be copied to {tempfile.gettempdir()} to be read there ({reason}); make room there, or name "
                "another folder in the environment variable TMPDIR"
            ) from error

    def _start(self) -> None:
        shared = (self._file.fileno(),) if self._file is not None and os.name == "posix" else ()
        self._process = subprocess.Popen(
            COMMAND,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            pass_fds=shared,
            # It imports what this process imports, from wherever that is.
            env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "OPENBLAS_NUM_THREADS": "1"},
        )

    def _ask(self, **order: object) -> dict[str, Any]:
        process = self._process
        if process is None or process.stdin is None:
            raise self._ended()
        try:
            process.stdin.write(json.dumps(order).encode() + b"\n")
            process.stdin.flush()
        except OSError as error:
            raise self._ended() from error
        return self._answer()

    def _answer(self) -> dict[str, Any]:
        """Return what the process says next; what is wrong with the file is an error."""
        line = self._bytes(None)
        try:
            answer: dict[str, Any] = json.loads(line)
        except ValueError as error:
            raise self._ended() from error
        match answer["kind"]:
            case "refused":
                raise ReadError(f"{answer['words']}; export the scan again")
            case "damaged":
                raise ReadError(f"its E57 data are damaged ({_reason(answer['words'])}); {TRUNCATED_HINT}")
            case "memory":
                self._end()
                raise ReadError("takes more memory than an E57 of its size should; export the scan again")
        return answer

    def _array(self, shape: tuple[int, int], dtype: type) -> NDArray[Any]:
        wanted = shape[0] * shape[1] * np.dtype(dtype).itemsize
        return np.frombuffer(self._bytes(wanted), dtype=dtype).reshape(shape)

    def _bytes(self, count: int | None) -> bytes:
        """Return so many bytes of the answer, or a line of it; end the process where they do not come."""
        process = self._process
        if process is None or process.stdout is None:
            raise self._ended()
        # Where the system does not count the time that it takes, the clock does.
        clock = threading.Timer(PATIENCE_S + self._n_bytes / CPU_BYTES_PER_S, process.kill)
        clock.daemon = True
        clock.start()
        try:
            got = process.stdout.readline(_MOST_LINE_BYTES) if count is None else process.stdout.read(count)
        finally:
            clock.cancel()
        if (count is None and not got.endswith(b"\n")) or (count is not None and len(got) < count):
            raise self._ended()
        return got

    def _ended(self) -> ReadError:
        self._end()
        return ReadError(
            "the library that reads E57 broke off over it; the file is damaged: export the scan again, or as LAS or PLY"
        )

    def _end(self) -> None:
        process, self._process = self._process, None
        if process is None:
            return
        process.kill()
        process.wait()
        for pipe in (process.stdin, process.stdout):
            if pipe is not None:
                with suppress(OSError):
                    pipe.close()


def _reason(words: str) -> str:
    """Return what the library says without what only its makers understand."""
    return excerpt(words.removeprefix("E57Exception: ").partition("\n")[0].partition(" (Error")[0], 100)
