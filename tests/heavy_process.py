"""One computing process for all servers of a test run: to start one takes two seconds, as it loads the libraries."""

import time

import pytest

from stair_inspector.viewer.compute import workshop
from stair_inspector.viewer.compute.heavy_process import Cancelled, HeavyProcess

_OWN = HeavyProcess
_PATIENCE_S = 5.0
"""How long what nobody wants any longer may go on: a small scan is measured sooner than a new process has started."""


class _Lent:
    """What a server takes for a heavy process of its own; closed, it leaves the process to the next server.

    What is no longer wanted is cancelled as by a heavy process, but the process is ended for it only after a while.
    """

    def __init__(self, process):
        self._process = process
        self._is_closed = False

    def run(self, function, *inputs, is_wanted=lambda: True):
        unwanted_since = None
        is_begun = False

        def may_go_on():
            nonlocal unwanted_since, is_begun
            if is_wanted() and not self._is_closed:
                unwanted_since = None
            elif not is_begun:
                return False
            elif unwanted_since is None:
                unwanted_since = time.monotonic()
            is_begun = True
            return unwanted_since is None or time.monotonic() - unwanted_since < _PATIENCE_S

        result = self._process.run(function, *inputs, is_wanted=may_go_on)
        if unwanted_since is not None:
            raise Cancelled
        return result

    def close(self):
        self._is_closed = True


@pytest.fixture(scope="session")
def heavy_process():
    process = _OWN()
    yield process
    process.close()


@pytest.fixture(scope="module", autouse=True)
def servers_share_a_process(request):
    """Lend the run's process to every server of a module; it starts with the first of them."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(workshop, "HeavyProcess", lambda: _Lent(request.getfixturevalue("heavy_process")))
        yield
