"""One computing process for all servers of a test run: to start one takes two seconds, as it loads the libraries."""

import pytest

from stair_inspector.viewer.compute import workshop
from stair_inspector.viewer.compute.heavy_process import HeavyProcess

_OWN = HeavyProcess


class _Lent:
    """What a server takes for a heavy process of its own; closed, it leaves the process to the next server."""

    def __init__(self, process):
        self._process = process
        self._is_closed = False

    def run(self, function, *inputs, is_wanted=lambda: True):
        return self._process.run(function, *inputs, is_wanted=lambda: is_wanted() and not self._is_closed)

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
