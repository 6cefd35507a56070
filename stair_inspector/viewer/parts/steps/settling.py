"""Which values hang on the settings: found out while nobody does anything, and marked on the page."""

from stair_inspector.stability import mark_unsettled
from stair_inspector.viewer.compute.heavy_process import Cancelled
from stair_inspector.viewer.compute.side_runs import memo_while
from stair_inspector.viewer.compute.threads import Newest, Settle
from stair_inspector.viewer.parts.part import Context
from stair_inspector.viewer.state.change import PageChange

QUIET_S = 1.5
"""A result that has stood for so long is looked into."""


class Settling:
    """Tries the notches beside the settings of a result that stands, and gives it up as soon as another is wanted."""

    def __init__(self, context: Context) -> None:
        self._desk = desk = context.desk
        self._workshop = context.workshop
        self._is_busy = context.runs.is_busy
        name = f"stair-settling-{desk.client.client_id}"
        self._runs: Newest[None] = Newest(lambda _: desk.notices.guard(self.look)(), name=name)
        self._settle = Settle(lambda: self._runs.submit(None), QUIET_S, f"{name}-wait")

    def close(self) -> None:
        """End the threads."""
        self._settle.close()
        self._runs.close()

    def renew(self) -> None:
        """Look into the present result when it has stood for a while."""
        self._settle.touch()

    def look(self) -> None:
        """Find the values of the present result that hang on the settings, and show them."""
        desk = self._desk
        shown = desk.shown
        if shown is None:
            return

        def is_wanted() -> bool:
            return not (desk.is_closed or self._is_busy()) and desk.inspection is shown.inspection

        inspection = shown.inspection
        try:
            if not is_wanted():
                raise Cancelled
            found = mark_unsettled(shown.scan, inspection.params, inspection, memo_while(self._workshop, is_wanted))
        except Cancelled:
            # The next result is looked into in its turn; a run that ends without one leaves this one standing.
            if not desk.is_closed and desk.inspection is inspection:
                self._settle.touch()
            return
        notes = found.notes[len(inspection.notes) :]
        with desk.lock:
            if notes and is_wanted():
                desk.unsettled = notes
                desk.changed(PageChange.SETTLED)
