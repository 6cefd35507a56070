"""Settings of the test run."""

import os

import hypothesis
import pytest

# scikit-learn, the oracle, counts physical cores and warns where the system does not tell; a warning fails a test.
os.environ.setdefault("LOKY_MAX_CPU_COUNT", "1")
# A shared machine may pause for longer than any deadline; the same examples every time, so that a failure repeats.
hypothesis.settings.register_profile("repeatable", deadline=None, derandomize=True, max_examples=200)
hypothesis.settings.load_profile("repeatable")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Keep the tests of a file in one process, and all that drive a browser: they share what is costly to make."""
    for item in items:
        group = "browser" if "browser" in item.path.parts else item.path.as_posix()
        item.add_marker(pytest.mark.xdist_group(group))
