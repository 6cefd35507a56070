"""Settings of the test run."""

import os

import hypothesis

# scikit-learn, the oracle, counts physical cores and warns where the system does not tell; a warning fails a test.
os.environ.setdefault("LOKY_MAX_CPU_COUNT", "1")
# A shared machine may pause for longer than any deadline; the same examples every time, so that a failure repeats.
hypothesis.settings.register_profile("repeatable", deadline=None, derandomize=True, max_examples=200)
hypothesis.settings.load_profile("repeatable")
