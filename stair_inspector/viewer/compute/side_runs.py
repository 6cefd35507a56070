"""Measuring beside a page's own runs, on a thread of its own: what is begun anew stops what went before."""

import threading
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from stair_inspector.errors import StairError
from stair_inspector.memo import Memo
from stair_inspector.viewer.bridge.notices import Notices
from stair_inspector.viewer.compute.heavy_process import Cancelled
from stair_inspector.viewer.compute.threads import Newest
from stair_inspector.viewer.compute.workshop import Workshop


@dataclass(frozen=True, slots=True, eq=False)
class SideJob:
    """One thing that is measured: whether it is still wanted, and a memo that ends when it is not."""

    is_wanted: Callable[[], bool]
    memo: Memo


class SideRuns:
    """The thread; runs of the page itself come first, and wait for nobody here.

    Parameters
    ----------
    workshop : Workshop
        For what takes long.
    notices : Notices
        Tell why something was not done.
    is_closed : callable
        Whether the page has gone.
    name : str
        Of the thread.
    """

    def __init__(self, workshop: Workshop, notices: Notices, is_closed: Callable[[], bool], name: str) -> None:
        self._workshop = workshop
        self._notices = notices
        self._is_closed = is_closed
        # One for each job: what was stopped must not stop the next.
        self._stop = threading.Event()
        self._job: SideJob | None = None
        self._newest: Newest[Callable[[], None]] = Newest(self._run, name=name)

    def start(self, work: Callable[[SideJob], None]) -> None:
        """Begin a job, and stop the one before; ``work`` raises Cancelled when it is no longer wanted."""
        self._stop.set()
        self._stop = stop = threading.Event()

        def is_wanted() -> bool:
            return not (stop.is_set() or self._is_closed())

        self._job = job = SideJob(is_wanted, memo_while(self._workshop, is_wanted))
        self._newest.submit(partial(work, job))

    def is_last(self, job: SideJob) -> bool:
        """Return whether no other job has been begun since."""
        return self._job is job

    def stop(self) -> None:
        """Stop the present job."""
        self._stop.set()

    def close(self) -> None:
        """Stop, and end the thread."""
        self.stop()
        self._newest.close()

    def _run(self, work: Callable[[], None]) -> None:
        try:
            work()
        except Cancelled:
            return
        except StairError as error:
            self._notices.tell("Not done", str(error), is_failure=True)
        except Exception:  # noqa: BLE001 - the outermost frame of this thread
            self._notices.log("a comparison or a sweep failed")
            self._notices.tell(
                "Not done", "an internal error stopped this; the server's log has the details", is_failure=True
            )


def memo_while(workshop: Workshop, is_wanted: Callable[[], bool]) -> Memo:
    """Return a memo that runs stages as long as they are wanted, what takes long in the workshop.

    A stage that is no longer wanted raises Cancelled.
    """

    def go_on(_: str) -> None:
        if not is_wanted():
            raise Cancelled

    return Memo(partial(workshop.heavy, is_wanted=is_wanted), go_on)
