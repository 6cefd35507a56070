"""The paper's edges in the scene while the sliders are moved that place them, and that change nothing else."""

import numpy as np

from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Inspection
from stair_inspector.pictures.segmentation import lift_of
from stair_inspector.viewer.bridge.controls import words_of_change
from stair_inspector.viewer.compute.threads import Settle
from stair_inspector.viewer.parts.part import Context
from stair_inspector.viewer.scene.nodes import NO_LINES, outline_of
from stair_inspector.viewer.state.change import PageChange

PAPER_ONLY = frozenset({"edges.front_percentile", "edges.back_percentile", "edges.side_percentile"})
"""Settings that act on the paper's columns alone where the survey is made."""
LINGER_S = 6.0
"""They stay for so long after the last move, to be looked at."""


def paper_edges_of(inspection: Inspection, spacing_m: float) -> Floats:
    """Return the front, back and side edges (k, 2, 3) that the paper places on the levels of the steps; local.

    Nothing where the paper's own steps are drawn anyway, and nothing on levels that the survey takes for no step.
    """
    if inspection.params.method == "paper":
        return NO_LINES
    # The lowest level is the floor to the paper, which has no edges.
    levels = sorted({patch.level_id for patch in inspection.patches if patch.step_id is not None} - {0})
    rms_m = max((step.plane.rms_m or 0.0 for step in inspection.steps), default=0.0)
    lift = lift_of(spacing_m, rms_m) * inspection.up.vector
    placed = dict(enumerate(inspection.paper_corners, 1))
    return np.concatenate([NO_LINES, *(outline_of(placed[level] + lift) for level in levels if level in placed)])


class PaperEdges:
    """Shows the paper's edges from the first move of one of their sliders until a while after the last.

    Another control that is touched puts them away at once.
    """

    def __init__(self, context: Context) -> None:
        self._desk = desk = context.desk
        self._editor = context.editor
        self._params = context.editor.work.params
        # From the move of a slider; drawn from the result of it.
        self._is_wanted = False
        self._settle = Settle(desk.notices.guard(self.put_away), LINGER_S, f"stair-paper-{desk.client.client_id}")

    def close(self) -> None:
        """End the thread."""
        self._settle.close()

    def follow(self, *, is_slider: bool) -> None:
        """Look which settings have changed, by a control that was moved or by something else."""
        before, self._params = self._params, self._editor.work.params
        names = words_of_change(before, self._params)[1]
        if not is_slider:
            self.put_away()
        elif names and set(names.split(", ")) <= PAPER_ONLY:
            self._is_wanted = True
            self._settle.touch()
        elif names:
            self.put_away()

    def draw(self) -> None:
        """Draw the edges of the present result, or none; the desk is held."""
        shown = self._desk.shown
        lines = NO_LINES
        if self._is_wanted and shown is not None:
            lines = paper_edges_of(shown.inspection, shown.display.spacing_m)
        self._desk.stage.show_paper_edges(lines, self._desk.palette)
        if self._desk.with_paper != (len(lines) > 0):
            self._desk.with_paper = len(lines) > 0
            self._desk.changed(PageChange.LEGEND)

    def put_away(self) -> None:
        """Take the edges away."""
        with self._desk.lock:
            self._is_wanted = False
            if self._desk.with_paper and not self._desk.is_closed:
                self.draw()
