"""Colour sets for pictures and the debug PLY."""

from dataclasses import MISSING, dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from stair_inspector.errors import ConfigError
from stair_inspector.files.paths import static_configs
from stair_inspector.files.toml import check_keys, read_toml
from stair_inspector.geometry.arrays import Colors, Labels

Rgb = tuple[int, int, int]


@dataclass(frozen=True, slots=True)
class Palette:
    """Colours, red green blue from 0 to 255; ``steps`` are used in turn from bottom to top.

    What has a default need not be named: the paper has no measuring lines, no surfaces that are rejected, and no
    limits. ``paper_edge`` is of the edges that the paper places beside those of the survey, ``outside`` of steps
    outside a limit, ``nearly`` where that is within the uncertainty.
    """

    title: str
    floor: Rgb
    non_stair: Rgb
    steps: tuple[Rgb, ...]
    front_edge: Rgb
    back_edge: Rgb
    side_edge: Rgb
    centre: Rgb
    measure: Rgb = (0, 190, 200)
    rejected: Rgb = (164, 116, 96)
    paper_edge: Rgb = (130, 50, 240)
    outside: Rgb = (224, 49, 49)
    nearly: Rgb = (232, 89, 12)

    def of_step(self, step_id: int) -> Rgb:
        """Return the colour of step 1, 2, ..."""
        return self.steps[(step_id - 1) % len(self.steps)]

    def of_labels(self, labels: Labels) -> Colors:
        """Return an (n, 3) colour for each label: -1 non-stair, 0 floor, k step k."""
        highest = int(labels.max(initial=0))
        table = np.array(
            [self.non_stair, self.floor, *(self.of_step(k) for k in range(1, highest + 1))], dtype=np.uint8
        )
        return np.take(table, labels.astype(np.intp) + 1, axis=0)


def read_palette(name: str) -> Palette:
    """Read ``static_configs/palettes/NAME.toml``.

    Raises
    ------
    ConfigError
        The file is missing, incomplete, or holds something that is no colour.
    """
    return _read(static_configs() / "palettes" / f"{name}.toml")


def _read(path: Path) -> Palette:
    values = read_toml(path)
    names = [item.name for item in fields(Palette)]
    check_keys(str(path), values, names)
    missing = [item.name for item in fields(Palette) if item.default is MISSING and item.name not in values]
    if missing:
        raise ConfigError(f"{path}: {missing[0]} is missing; add it")
    if not isinstance(values["steps"], list) or not values["steps"]:
        raise ConfigError(f"{path}: steps: give a list of at least one colour")
    steps = tuple(_rgb(f"{path}: steps", value) for value in values["steps"])
    single = {name: _rgb(f"{path}: {name}", values[name]) for name in values if name not in ("title", "steps")}
    return Palette(title=str(values["title"]), steps=steps, **single)


def _rgb(place: str, value: Any) -> Rgb:
    is_channel = isinstance(value, list) and [type(v) is int and 0 <= v <= 255 for v in value]
    if is_channel != [True, True, True]:
        raise ConfigError(f"{place}: got {value!r}; give three whole numbers from 0 to 255")
    return (value[0], value[1], value[2])
