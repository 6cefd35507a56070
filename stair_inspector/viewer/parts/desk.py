"""What the parts of one inspector's page share: the last good result, what is chosen, and how it is shown."""

import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import viser

from stair_inspector.errors import ConfigError, one_of
from stair_inspector.files.palettes import Palette
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import ComparedScan, HeightOrder, Inspection, Note, Scan
from stair_inspector.pictures.coloring import rejected_of
from stair_inspector.pictures.display import Display
from stair_inspector.pictures.frames import step_of
from stair_inspector.pictures.picture import safe_name
from stair_inspector.pictures.segmentation import SURFACE
from stair_inspector.units import Unit, read_unit
from stair_inspector.viewer.bridge.notices import Notices
from stair_inspector.viewer.parts.step_columns import USUAL_LOOK, TableLook
from stair_inspector.viewer.scene.stage import Stage
from stair_inspector.viewer.scene.step_marks import StepMark
from stair_inspector.viewer.state.change import PageChange
from stair_inspector.viewer.state.status import PageStatus

USUAL_PALETTE = "the page's"
"""Name of the colours that a page begins with."""


@dataclass(frozen=True, slots=True, eq=False)
class Shown:
    """The last good result, with the scan it belongs to and what of it is drawn."""

    label: str
    scan: Scan
    display: Display
    inspection: Inspection

    @property
    def stem(self) -> str:
        """What files about the scan are called; two scans of the same name have the folder in their label."""
        return safe_name(Path(self.label).with_suffix("").as_posix())

    def drawn_as(self, display: Display) -> "Shown":
        """Return the same result with other points drawn."""
        return replace(self, display=display)


@dataclass(slots=True, eq=False)
class Desk:
    """The state of one page.

    ``lock`` is held while anything here is read or changed together with the page; viser runs callbacks on many
    threads. ``selected`` is a step, ``selected_patch`` a rejected surface; never both. ``unsettled`` are notes on
    values of the last good result that hang on the settings: found afterwards, and no part of it. ``marks`` are those
    of steps that are outside a limit; see :class:`~stair_inspector.viewer.parts.judge.Judge`. ``heights`` is what
    the last run has sorted, from which settings are suggested. ``table`` is how the table of steps is looked at.
    ``point_taker`` is given the points that are picked in the scene, in
    the scan's frame, instead of the measure tool. ``changed`` lets the parts of the page that depend on a change show
    themselves. ``palettes`` has for each name the colours on the light and on the dark theme.
    """

    client: viser.ClientHandle
    notices: Notices
    palettes: Mapping[str, tuple[Palette, Palette]]
    stage: Stage
    lock: threading.RLock = field(default_factory=threading.RLock)
    is_dark: bool = False
    palette_name: str = USUAL_PALETTE
    unit: Unit = "mm"
    shown: Shown | None = None
    selected: int | None = None
    selected_patch: int | None = None
    is_closed: bool = False
    unsettled: tuple[Note, ...] = ()
    heights: HeightOrder | None = None
    compared: ComparedScan | None = None
    uncompared: str = ""
    marks: Mapping[int, StepMark] = field(default_factory=dict)
    with_rejected: bool = False
    with_paper: bool = False
    table: TableLook = USUAL_LOOK
    status: PageStatus = field(default_factory=PageStatus)
    point_taker: Callable[[tuple[float, float, float]], None] | None = None
    changed: Callable[..., None] = lambda *_: None

    @property
    def palette(self) -> Palette:
        """The colours that were chosen, of the present theme."""
        return self.palettes[self.palette_name][self.is_dark]

    @property
    def paper_palette(self) -> Palette:
        """The colours that were chosen, on white."""
        return self.palettes[self.palette_name][False]

    @property
    def inspection(self) -> Inspection | None:
        """The last good result's numbers."""
        return self.shown.inspection if self.shown is not None else None

    @property
    def marked(self) -> Inspection | None:
        """The last good result with the notes on its values that hang on the settings, for what the page says of it."""
        inspection = self.inspection
        if inspection is None or not self.unsettled:
            return inspection
        return replace(inspection, notes=(*inspection.notes, *self.unsettled))

    @property
    def frame(self) -> tuple[str, str] | None:
        """Whose frame coordinates are in: the scan by its name in the list, and the unit that it was read in."""
        return (self.shown.label, self.shown.scan.unit) if self.shown is not None else None

    def show(self, shown: Shown) -> None:
        """Take another result, and drop what it no longer has of what was chosen; the lock is held."""
        if self.inspection is not shown.inspection:
            self.compared = None
        self.shown, self.unsettled = shown, ()
        if step_of(shown.inspection, self.selected) is None:
            self.selected = None
        # Surfaces are numbered anew by every run.
        self.selected_patch = None

    def clear(self) -> None:
        """Forget the result of a scan that is no longer open; the lock is held."""
        self.shown = self.selected = self.selected_patch = self.compared = None
        self.unsettled, self.table = (), replace(self.table, folded=frozenset())

    def select(self, step_id: int | None, patch_id: int | None = None) -> None:
        """Choose a step or a rejected surface, or nothing.

        Raises
        ------
        ConfigError
            There is no such step or surface.
        """
        with self.lock:
            inspection = self.inspection
            if inspection is None:
                return
            if step_id is not None and step_of(inspection, step_id) is None:
                raise ConfigError(f"step {step_id} does not exist; there are {len(inspection.steps)}")
            if patch_id is not None and patch_id not in {patch.patch_id for patch in rejected_of(inspection)}:
                raise ConfigError(f"{SURFACE} {patch_id} is none of the rejected ones")
            self.selected, self.selected_patch = step_id, patch_id
            self.changed(PageChange.SELECTION)

    def move(self, by: int) -> None:
        """Choose the next step upwards (1) or downwards (-1); the first or the last where none is chosen."""
        with self.lock:
            numbers = [step.step_id for step in self.inspection.steps] if self.inspection is not None else []
            if not numbers:
                return
            if self.selected not in numbers:
                chosen = numbers[0 if by > 0 else -1]
            else:
                chosen = numbers[min(max(numbers.index(self.selected) + by, 0), len(numbers) - 1)]
            self.select(chosen)

    def set_unit(self, option: str) -> None:
        """Write lengths in millimetres or in inches."""
        unit = read_unit(option)
        with self.lock:
            self.unit = unit
            self.changed(PageChange.UNIT)

    def set_theme(self, is_dark: bool) -> None:
        """Show the page light or dark."""
        with self.lock:
            self.is_dark = bool(is_dark)
            self.changed(PageChange.THEME)

    def stop_taking(self, taker: Callable[[tuple[float, float, float]], None]) -> bool:
        """Give up taking points, where it is this one that takes them, and return whether it was; the lock is held."""
        is_own = self.point_taker == taker
        if is_own:
            self.point_taker = None
        return is_own

    def set_palette(self, option: str) -> None:
        """Draw the result in other colours.

        Raises
        ------
        ConfigError
            There are no such colours.
        """
        name = one_of(str(option), tuple(self.palettes), "colours of steps")
        with self.lock:
            self.palette_name = name
            self.changed(PageChange.COLORS, PageChange.THEME)

    def result(self, what: str) -> Shown:
        """Return the last good result.

        Raises
        ------
        ConfigError
            There is none yet; ``what`` names what needs it.
        """
        if self.shown is None:
            raise ConfigError(f"{what}: there is no result yet; wait for the first one")
        return self.shown

    def inspection_to_send(self, what: str) -> Inspection:
        """Return the last good inspection with its notes as in :attr:`marked`, for files; raises as :meth:`result`."""
        return self.marked or self.result(what).inspection

    def compared_of(self, shown: Shown) -> ComparedScan | None:
        """Return what changed against a second scan, None where that is of another result than this one."""
        return self.compared if shown.inspection is self.inspection else None

    def comparison(self, what: str) -> ComparedScan | None:
        """Return what changed against a second scan, None where none was chosen.

        Raises
        ------
        ConfigError
            One was chosen, and what changed is not known; ``what`` names what needs it.
        """
        if self.compared is None and self.uncompared:
            raise ConfigError(f"{what}: {self.uncompared}")
        return self.compared

    def to_view(self, points: Floats) -> Floats:
        """Return places of the view for places of the scan's own frame, (..., 3) metres."""
        shown = self.result("place")
        place: Floats = (np.asarray(points, dtype=np.float64) - shown.scan.origin_m) @ self.stage.rotation.T
        return place
