"""What the parts of one inspector's page share: the last good result, what is chosen, and how it is shown."""

import threading
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Protocol, Unpack

import numpy as np
import viser

from stair_inspector.errors import ConfigError
from stair_inspector.files.palettes import Palette
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Inspection, Note, Scan
from stair_inspector.params import Params
from stair_inspector.pictures.display import Display
from stair_inspector.pictures.picture import safe_name
from stair_inspector.units import Unit
from stair_inspector.viewer.bridge.notices import Notices
from stair_inspector.viewer.scene.stage import Stage
from stair_inspector.viewer.state.work import Changes, Work


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


@dataclass(slots=True, eq=False)
class Desk:
    """The state of one page.

    ``lock`` is held while anything here is read or changed together with the page; viser runs callbacks on many
    threads. ``selected`` is a step, ``selected_patch`` a rejected surface; never both. ``unsettled`` are notes on
    values of the last good result that hang on the settings: found afterwards, and no part of it.
    """

    client: viser.ClientHandle
    notices: Notices
    palettes: tuple[Palette, Palette]
    stage: Stage
    lock: threading.RLock = field(default_factory=threading.RLock)
    is_dark: bool = False
    unit: Unit = "mm"
    shown: Shown | None = None
    selected: int | None = None
    selected_patch: int | None = None
    is_closed: bool = False
    unsettled: tuple[Note, ...] = ()

    @property
    def palette(self) -> Palette:
        """The colours of the present theme."""
        return self.palettes[self.is_dark]

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
        """Whose frame coordinates are in: the scan by its name in the menu, and the unit that it was read in."""
        return (self.shown.label, self.shown.scan.unit) if self.shown is not None else None

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

    def to_scan(self, points: Floats) -> Floats:
        """Return places of the scan's own frame, (..., 3) metres, for places of the view."""
        shown = self.result("place")
        local: Floats = np.asarray(points, dtype=np.float64) @ self.stage.rotation
        place: Floats = local + shown.scan.origin_m
        return place

    def to_view(self, points: Floats) -> Floats:
        """Return places of the view for places of the scan's own frame, (..., 3) metres."""
        shown = self.result("place")
        place: Floats = (np.asarray(points, dtype=np.float64) - shown.scan.origin_m) @ self.stage.rotation.T
        return place


class Editor(Protocol):
    """What parts of the page may change of the work; each change can be undone and is saved."""

    @property
    def work(self) -> Work:
        """The work as it stands."""

    def adjust(self, change: Callable[[Params], Params], words: str = "") -> None:
        """Change the settings as they stand at that moment, set the controls to them, and run."""

    def take_up(self, work: Work, words: str) -> None:
        """Go on with other work, all in one change, and run."""

    def edit(self, words: str, change: Callable[[Work], Changes], merge_key: str = "") -> None:
        """Change other parts of the work, as it stands at that moment, and show them.

        Changes that follow each other with the same key, as while a text is typed, are undone together.
        """

    def change(self, words: str, **fields: Unpack[Changes]) -> None:
        """Change other parts of the work, whatever they are now, and show them."""

    def submit(self) -> None:
        """Run with what the controls show."""

    def show_runs(self) -> None:
        """Show the kept runs, and the comparison with the chosen one."""
