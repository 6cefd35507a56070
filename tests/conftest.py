"""Settings of the test run."""

import os
from typing import Any

import hypothesis
import pytest
from xdist.scheduler import LoadScopeScheduling

# scikit-learn, the oracle, counts physical cores and warns where the system does not tell; a warning fails a test.
os.environ.setdefault("LOKY_MAX_CPU_COUNT", "1")
# A shared machine may pause for longer than any deadline; the same examples every time, so that a failure repeats.
hypothesis.settings.register_profile("repeatable", deadline=None, derandomize=True, max_examples=100)
hypothesis.settings.load_profile("repeatable")

REPLACED = "replaced its page"
"""Property of a test after which the page that tests share could not be put in order; its value says why."""

TOGETHER = {
    "browser": ("tests/browser/",),
    "samples": (
        *("tests/content/", "tests/pictures/", "tests/writers/"),
        *("tests/test_samples.py", "tests/test_checked_samples.py", "tests/test_cli_check.py"),
    ),
}
"""What many files share by the start of their paths: one browser, and what is measured of the bundled samples."""
LONGEST = ("browser", "tests/test_up_and_unit.py", "tests/benchmarks/test_hostile_scans.py", "samples")
"""What is begun first."""


class FilesTogether(LoadScopeScheduling):
    """Deals the tests out so that those of a file, and those of files that share much, are in one process.

    They share what is costly to make. Groups by mark are not used: they need a name of pytest's that it has given up.
    """

    def _split_scope(self, nodeid: str) -> str:
        file = nodeid.split("::", 1)[0]
        return next((scope for scope, files in TOGETHER.items() if file.startswith(files)), file)

    def _assign_work_unit(self, node: Any) -> None:
        """Give out first what takes longest, though it has not the most tests: at the end a process would idle."""
        for scope in LONGEST:
            if scope in self.workqueue:
                self.workqueue.move_to_end(scope, last=False)
                break
        super()._assign_work_unit(node)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> LoadScopeScheduling:
    """Hand the plugin that runs the tests in several processes its order."""
    return FilesTogether(config, log)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say after which tests a page that many share had to be replaced: it costs time and may hide what is wrong."""
    for report in (each for reports in terminalreporter.stats.values() for each in reports):
        if isinstance(report, pytest.TestReport) and report.when == "teardown":
            for name, value in report.user_properties:
                if name == REPLACED:
                    terminalreporter.line(f"{report.nodeid} {name}: {value}")
