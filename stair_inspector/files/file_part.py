"""Which part of a file is read: a box of its own coordinates, and how finely."""

from dataclasses import dataclass

import numpy as np

from stair_inspector.declarations import Box, check_value
from stair_inspector.errors import ConfigError
from stair_inspector.geometry.arrays import Bools, Floats


@dataclass(frozen=True, slots=True)
class FilePart:
    """What is read of a file: ``box`` in the file's own coordinates, None for everything; ``detail_m``, 0 for all.

    ``margin``, in the unit of the file, is how far beyond the box it is looked whether the file goes on.
    Raises ConfigError for a ``detail_m`` that is no distance.
    """

    box: Box | None = None
    detail_m: float = 0.0
    margin: float = 0.0

    def __post_init__(self) -> None:
        check_value("detail_m", self.detail_m, float, None)
        if self.detail_m < 0.0:
            raise ConfigError(f"detail_m: got {self.detail_m:g}; give a distance, or 0 for every point")

    def holds(self, points: Floats) -> Bools:
        """Return which points (n, 3), in the file's own coordinates, lie in the box, its faces included: (n,)."""
        if self.box is None:
            return np.ones(len(points), dtype=np.bool_)
        inside: Bools = np.all((points >= self.box[0]) & (points <= self.box[1]), axis=1)
        return inside


WHOLE_FILE = FilePart()
"""Everything."""
