"""What two inspections of one stair have in common, and in what they differ.

Earlier and later are the two scans; a change is the later value less the earlier one. "Level frame" is the earlier
scan's local axes turned so that the third is up; the later scan is laid into it by the alignment.
"""

from dataclasses import dataclass

from stair_inspector.geometry.arrays import Bools, Floats
from stair_inspector.model.inspection import ScanSummary
from stair_inspector.model.notes import Note
from stair_inspector.model.steps import Measured


@dataclass(frozen=True, slots=True, eq=False)
class EpochAlignment:
    """The motion that lays the later scan onto the earlier one: ``turn`` (3, 3), ``shift_m`` (3,), local axes.

    A point of the later scan, local, comes to lie at ``turn @ point + shift``. ``steady_ids`` are the steps of the
    earlier scan whose treads agree with it, ``is_floor_steady`` whether the floor does: they are what it rests on.
    ``u_m`` is the largest expanded uncertainty (k = 2) of a height after it, on any step; ``parts`` are what it is made
    of, each with its unit in the name, expanded: height, tilts, shifts in plan, turn. ``covariance`` (3, 3) is that of
    a height and its slopes along the first two axes of the level frame, at ``centre_m`` (2,) there.
    """

    turn: Floats
    shift_m: Floats
    steady_ids: tuple[int, ...]
    is_floor_steady: bool
    u_m: float
    parts: tuple[tuple[str, float], ...]
    covariance: Floats
    centre_m: Floats


@dataclass(frozen=True, slots=True)
class ValueChange:
    """The change of one quantity of one step, by the quantity's name; None where a scan has no value.

    ``change`` is later less earlier, its ``u`` (k = 2) the root of the sum of the squares of both. ``is_changed`` says
    that the change exceeds it, and also what the largest of as many changes as were compared is by chance.
    """

    quantity: str
    before: Measured | None
    after: Measured | None
    change: Measured | None
    is_changed: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class TreadDeviations:
    """How far the later surface of a tread lies off the earlier one, along its normal, upwards positive.

    A grid of square cells of ``cell_m``: row i, column j begins at ``corner + i * ahead + j * aside``, (3,) local of
    the earlier scan; ``ahead`` and ``aside`` are a cell long, along the climb and to its left. ``deviation_m``
    (rows, columns) is the difference of the cell's medians, NaN where not both scans saw it; ``u_m`` its expanded
    uncertainty. ``is_tread`` marks the cells that belong to the tread, ``coverage`` the share of them that both saw.
    ``is_local`` marks those that differ from the rest of the tread beyond chance, as where it is worn; ``worst_m`` is
    the deviation of them that is largest in size, against the rest of the tread, None without any.
    """

    cell_m: float
    corner: Floats
    ahead: Floats
    aside: Floats
    normal: Floats
    deviation_m: Floats
    u_m: Floats
    is_tread: Bools
    is_local: Bools
    coverage: float
    worst_m: Measured | None


@dataclass(frozen=True, slots=True, eq=False)
class StepChange:
    """One step in both scans: its number in each, the changes of its values, and the map of its tread.

    ``height`` is the change of the height of the tread's plane in its middle, after the alignment.
    """

    before_id: int
    after_id: int
    kind: str
    values: tuple[ValueChange, ...]
    height: ValueChange
    deviations: TreadDeviations | None
    is_steady: bool

    @property
    def is_changed(self) -> bool:
        """Whether anything about the step changed."""
        is_worn = self.deviations is not None and self.deviations.worst_m is not None
        return is_worn or self.height.is_changed or any(value.is_changed for value in self.values)


@dataclass(frozen=True, slots=True, eq=False)
class ScanComparison:
    """Two inspections of one stair, laid onto each other on what did not move.

    ``steps`` are those found in both, from bottom to top; ``only_before`` and ``only_after`` the numbers of the others.
    ``floor`` is the change of the floor's height in front of the stair. ``notes`` tell in words what changed.
    """

    before: ScanSummary
    after: ScanSummary
    alignment: EpochAlignment
    steps: tuple[StepChange, ...]
    floor: ValueChange
    only_before: tuple[int, ...]
    only_after: tuple[int, ...]
    notes: tuple[Note, ...]


@dataclass(frozen=True, slots=True, eq=False)
class ComparedScan:
    """A comparison as one of its two scans sees it: ``is_earlier`` tells whether that is the earlier one."""

    found: ScanComparison
    is_earlier: bool

    def number_of(self, step: StepChange) -> int:
        """Return the number of a step in this scan."""
        return step.before_id if self.is_earlier else step.after_id

    @property
    def name(self) -> str:
        """What this scan is called."""
        return self.found.before.name if self.is_earlier else self.found.after.name
