"""Reading, measuring and comparing a second scan, beside the page's own runs."""

from collections.abc import Callable
from dataclasses import dataclass

from stair_inspector.comparison.compare import compare_scans
from stair_inspector.errors import CannotMeasure, ConfigError, ReadError
from stair_inspector.files.projects import SecondScan
from stair_inspector.model import ComparedScan, Inspection, Scan
from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from stair_inspector.viewer.compute.side_runs import SideJob
from stair_inspector.viewer.compute.workshop import Workshop
from stair_inspector.viewer.parts.desk import Shown
from stair_inspector.viewer.state.opening import Opening

Told = Callable[[str], None]
"""Takes what is being done, in words."""


class ChangedScanError(ReadError):
    """The second scan's file is no longer what it was when it was chosen."""


@dataclass(frozen=True, slots=True, eq=False)
class _Measured:
    """The second scan as it was measured last."""

    scan: Scan
    params: Params
    inspection: Inspection


class SecondMeasured:
    """Measures the second scan with the settings of the first, and keeps it until another one is wanted."""

    def __init__(self, opening: Opening, workshop: Workshop) -> None:
        self._opening = opening
        self._workshop = workshop
        self._last: _Measured | None = None

    def chosen(self, label: str, shown: Shown, job: SideJob, *, is_earlier: bool) -> SecondScan:
        """Read a scan of the list, and return it as the second one.

        Raises
        ------
        ConfigError
            It is the scan that is open.
        StairError
            It cannot be read.
        Cancelled
            It is no longer wanted.
        """
        scan = self._read(label, self._opening.settings_of(label, shown.inspection.params), job)
        _check_other(label, scan, shown)
        return SecondScan(str(self._opening.path_of(label).absolute()), scan.sha256, is_earlier)

    def compare(self, second: SecondScan, shown: Shown, job: SideJob, tell: Told) -> ComparedScan:
        """Return what changed between the scan that is shown and a second one.

        Raises
        ------
        ReadError
            The file is gone, or has changed.
        ConfigError
            It is the scan that is open.
        StairError
            It cannot be measured, or not compared.
        Cancelled
            It is no longer wanted.
        """
        label = self._opening.label_of(second)
        if label is None:
            raise ReadError(
                f"{second.shown_name}: this second scan is not among the scans of this server; start it with that file "
                "or its folder too, or upload it, or end the comparison"
            )
        tell(f"reading {label} …")
        params = self._opening.settings_of(label, shown.inspection.params)
        scan = self._read(label, params, job)
        if scan.sha256 != second.sha256:
            raise ChangedScanError(
                f"{label}: has changed since it was chosen as the second scan; compare anew to take it as it is now, "
                "or end the comparison"
            )
        _check_other(label, scan, shown)
        tell(f"measuring {label} …")
        other = self._inspected(scan, params, job)
        _check_answered(shown.label, shown.inspection, "answer it above the tabs")
        _check_answered(label, other, "open it by itself, answer it there, and compare anew")
        tell(f"laying {label} onto {shown.label} …")
        ours, theirs = (shown.scan, shown.inspection), (scan, other)
        earlier, later = (theirs, ours) if second.is_earlier else (ours, theirs)
        found = self._workshop.heavy(compare_scans, *earlier, *later, is_wanted=job.is_wanted)
        return ComparedScan(found, is_earlier=not second.is_earlier)

    def _read(self, label: str, params: Params, job: SideJob) -> Scan:
        return self._workshop.read(self._opening.path_of(label), params.reading, job.is_wanted)

    def _inspected(self, scan: Scan, params: Params, job: SideJob) -> Inspection:
        last = self._last
        if last is None or last.scan is not scan or last.params != params:
            last = self._last = _Measured(scan, params, inspect(scan, params, job.memo))
        return last.inspection


def _check_other(label: str, scan: Scan, shown: Shown) -> None:
    if scan.sha256 == shown.scan.sha256:
        raise ConfigError(f"{label}: is the scan that is open; choose another scan of the same stair")


def _check_answered(label: str, inspection: Inspection, cure: str) -> None:
    if inspection.is_withheld:
        question = inspection.questions[0].message
        raise CannotMeasure(f"{label}: cannot be compared before this is answered: {question}; {cure}")
