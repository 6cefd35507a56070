"""Settings of the test run."""

import hypothesis

# A shared machine may pause for longer than any deadline; the same examples every time, so that a failure repeats.
hypothesis.settings.register_profile("repeatable", deadline=None, derandomize=True, max_examples=200)
hypothesis.settings.load_profile("repeatable")
