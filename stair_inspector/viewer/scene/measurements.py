"""Points and distances that an inspector takes by clicking: how they add up, how they are drawn and listed.

The measurements are :class:`~stair_inspector.files.projects.Measurement` values of the project; every change here
returns another tuple, so that a history can undo it.
"""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from stair_inspector.errors import ConfigError, one_of
from stair_inspector.files.projects import Measurement
from stair_inspector.geometry.arrays import Floats, Point
from stair_inspector.units import NOT_KNOWN, Unit, length_text, tidy
from stair_inspector.viewer.bridge.markup import DIM, LINE, aside, list_key, order_button, text
from stair_inspector.viewer.scene.dimensions import Anchor

RulerMode = Literal["Off", "Point", "Distance"]
Order = Literal["delete", "show"]

RULER_MODES: tuple[RulerMode, ...] = ("Off", "Point", "Distance")
ORDERS: tuple[Order, ...] = ("delete", "show")
_LEG_SHORTEST_M = 1e-4


@dataclass(frozen=True, slots=True)
class Parts:
    """A distance, its length in plan and its height, metres; the height is positive upwards."""

    distance_m: float
    horizontal_m: float
    vertical_m: float


@dataclass(frozen=True, slots=True, eq=False)
class MeasureDrawing:
    """Measurements as plain data, local metres.

    ``lines`` (k, 2, 3) the distances, ``legs`` (l, 2, 3) their level and upright parts, ``points`` (p, 3) what was
    picked, ``labels`` node name, words, place (3,) and anchor of each.
    """

    lines: Floats
    legs: Floats
    points: Floats
    labels: tuple[tuple[str, str, Floats, Anchor], ...]


@dataclass
class Ruler:
    """What a click measures, and the first point of a distance that waits for its second one (scan's frame)."""

    mode: RulerMode = "Off"
    waiting: Point | None = None

    def set_mode(self, value: object) -> None:
        """Choose what a click measures; a point that waits is forgotten.

        Raises
        ------
        ConfigError
            It is none of :data:`RULER_MODES`.
        """
        self.mode, self.waiting = one_of(value, RULER_MODES, "measure"), None

    def step_back(self) -> bool:
        """Forget the point that waits; return whether there was one."""
        had = self.waiting is not None
        self.waiting = None
        return had

    def click(self, place_m: Point, known: tuple[Measurement, ...]) -> Measurement | None:
        """Take a picked point, scan's frame; return the measurement that is now complete, under a name of its own."""
        if self.mode == "Point":
            return Measurement(free_name("Point", _names(known)), (place_m,))
        if self.mode == "Off":
            return None
        if self.waiting is None:
            self.waiting = place_m
            return None
        # A second click on the very same point is no distance.
        if self.waiting == place_m:
            return None
        first, self.waiting = self.waiting, None
        return Measurement(free_name("Distance", _names(known)), (first, place_m))


def parts_of(measurement: Measurement, up: Floats) -> Parts | None:
    """Return a distance with its parts in plan and along ``up`` (3,), or None for a single point."""
    if len(measurement.points_m) < 2:
        return None
    # Points far from zero: their difference first.
    move = np.array(measurement.points_m[1]) - np.array(measurement.points_m[0])
    vertical = float(move @ up)
    return Parts(float(np.linalg.norm(move)), float(np.linalg.norm(move - vertical * up)), vertical)


def words_of(measurement: Measurement, up: Floats, unit: Unit) -> str:
    """Return what a measurement says: a distance with its parts, or a point's coordinates in the scan's frame."""
    parts = parts_of(measurement, up)
    if parts is None:
        return ", ".join(f"{tidy(value, 3):.3f}" for value in measurement.points_m[0]) + " m"
    return (
        f"{length_text(parts.distance_m, unit)} (horizontal {length_text(parts.horizontal_m, unit)}, "
        f"vertical {length_text(parts.vertical_m, unit)})"
    )


def renamed(measurements: tuple[Measurement, ...], index: int, name: str) -> tuple[Measurement, ...]:
    """Return the measurements with one under another name.

    Raises
    ------
    ConfigError
        There is no such measurement, the name is none, or another one has it.
    """
    chosen = measurements[_checked(measurements, index)]
    if any(other.name == name for other in measurements if other is not chosen):
        raise ConfigError(f"measurement: the name {name[:60]!r} is taken; give another one")
    return tuple(replace(entry, name=name) if entry is chosen else entry for entry in measurements)


def without(measurements: tuple[Measurement, ...], index: int) -> tuple[Measurement, ...]:
    """Return the measurements but one.

    Raises
    ------
    ConfigError
        There is no such measurement.
    """
    index = _checked(measurements, index)
    return measurements[:index] + measurements[index + 1 :]


def drawing_of(
    measurements: tuple[Measurement, ...],
    waiting: Point | None,
    origin_m: tuple[float, float, float],
    up: Floats,
    unit: Unit,
    detailed: int | None = None,
) -> MeasureDrawing:
    """Return what is drawn of measurements.

    Only one of them has all of its values beside it: the labels of many would lie on each other, and the list has them.

    Parameters
    ----------
    measurements : tuple of Measurement
        Scan's frame.
    waiting : (3,), optional
        First point of a distance whose second one is still to come, scan's frame.
    origin_m : (3,)
        What local coordinates lack, ``inspection.scan.origin_m``.
    up : (3,)
        Upwards, unit vector.
    unit : {"mm", "in"}
        Of the labels.
    detailed : int, optional
        Index of the measurement that has its parts or coordinates beside it; the last one without.
    """
    if detailed is None or detailed >= len(measurements):
        detailed = len(measurements) - 1
    origin = np.array(origin_m)
    lines, legs, points = [], [], []
    labels: list[tuple[str, str, Floats, Anchor]] = []
    for number, measurement in enumerate(measurements, start=1):
        places = np.array(measurement.points_m) - origin
        points += list(places)
        parts = parts_of(measurement, up)
        if parts is None:
            told = f": {words_of(measurement, up, unit)}" if number - 1 == detailed else ""
            labels.append((str(number), f"{measurement.name}{told}", places[0], "bottom-left"))
            continue
        low, high = places if parts.vertical_m >= 0.0 else places[::-1]
        corner = low + abs(parts.vertical_m) * up
        lines.append((low, high))
        if min(abs(parts.vertical_m), parts.horizontal_m) > _LEG_SHORTEST_M:
            legs += [(low, corner), (corner, high)]
        # On a leg that is as good as the distance itself its own label would only cover the other's.
        if number - 1 == detailed and min(abs(parts.vertical_m), parts.horizontal_m) > _LEG_SHORTEST_M:
            vertical, horizontal = (length_text(value, unit) for value in (parts.vertical_m, parts.horizontal_m))
            labels.append((f"{number}v", f"↕ {vertical}", (low + corner) / 2.0, "bottom-right"))
            labels.append((f"{number}h", f"↔ {horizontal}", (corner + high) / 2.0, "bottom-left"))
        told = f"{measurement.name}: {length_text(parts.distance_m, unit)}"
        labels.append((str(number), told, (low + high) / 2.0, "top-left"))
    if waiting is not None:
        points.append(np.array(waiting) - origin)
        labels.append(("waiting", "first point", points[-1], "bottom-left"))
    return MeasureDrawing(
        lines=np.array(lines, dtype=np.float64).reshape(-1, 2, 3),
        legs=np.array(legs, dtype=np.float64).reshape(-1, 2, 3),
        points=np.array(points, dtype=np.float64).reshape(-1, 3),
        labels=tuple(labels),
    )


def measurements_html(measurements: tuple[Measurement, ...], up: Floats | None, unit: Unit, order_uuid: str) -> str:
    """Return the list of measurements, a row for each with its values and buttons to look at it and to delete it.

    Parameters
    ----------
    measurements : tuple of Measurement
        Their names come from a file or a text field and are escaped.
    up : (3,), optional
        Upwards; without a result distances have no parts.
    unit : {"mm", "in"}
        Of the lengths.
    order_uuid : str
        Identity of the control that a button writes to.
    """
    if not measurements:
        words = "Nothing measured yet: choose Point or Distance, then shift-click in the scene."
        return aside("measurements", words)
    cells = "padding:2px 3px;text-align:right;white-space:nowrap"
    head = "".join(
        f'<th style="{cells};font-weight:400;color:{DIM}">{name}</th>'
        for name in ("", "distance", "horizontal", "vertical", "")
    )
    rows = []
    key = list_key(measurements)
    for number, entry in enumerate(measurements, start=1):
        parts = parts_of(entry, up) if up is not None else None
        if len(entry.points_m) == 1:
            place = words_of(entry, np.zeros(3), unit)
            values = f'<td colspan="3" style="{cells}" title="x, y, z in the scan\'s own frame">{place}</td>'
        elif parts is None:
            values = f'<td style="{cells}">{NOT_KNOWN}</td>' * 3
        else:
            values = "".join(
                f'<td style="{cells}">{length_text(value, unit)}</td>'
                for value in (parts.distance_m, parts.horizontal_m, parts.vertical_m)
            )
        buttons = order_buttons(order_uuid, key, number, entry.name)
        rows.append(
            f'<tr data-testid="measurement-row" data-measurement="{number}" style="border-bottom:1px solid {LINE}">'
            f'<td style="padding:2px 4px;overflow-wrap:anywhere">{text(entry.name)}</td>{values}'
            f'<td style="{cells}">{buttons}</td></tr>'
        )
    return (
        '<div data-testid="measurements" style="font-size:12px;line-height:1.35;padding:0 12px 6px 5px">'
        '<table style="border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums">'
        f"<thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table></div>"
    )


def order_buttons(order_uuid: str, key: int, number: int, name: str) -> str:
    """Return the buttons of a list's row that show and delete what is named."""
    signs: tuple[tuple[Order, str, str], ...] = (("show", "◎", "look at"), ("delete", "✕", "delete"))
    return "".join(
        order_button(order_uuid, order, key, number, f"{words} {name}", sign) for order, sign, words in signs
    )


def free_name(word: str, taken: set[str]) -> str:
    """Return the word with the first number that makes a name of its own: ``Distance 2``."""
    return next(f"{word} {k}" for k in range(1, len(taken) + 2) if f"{word} {k}" not in taken)


def _names(known: tuple[Measurement, ...]) -> set[str]:
    return {entry.name for entry in known}


def _checked(measurements: tuple[Measurement, ...], index: int) -> int:
    if not 0 <= index < len(measurements):
        raise ConfigError(f"measurement {index + 1}: there are {len(measurements)}; choose a row of the list")
    return index
