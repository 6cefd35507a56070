"""The buttons under what was found about a scan: each takes the settings that answer a question, or mend a doubt."""

from stair_inspector.viewer.bridge.markup import read_order
from stair_inspector.viewer.parts.examination_html import CURE, offered_cures
from stair_inspector.viewer.parts.part import Context


class Cures:
    """Takes what the buttons of one list of observations ask for; they write to the control ``uuid``."""

    def __init__(self, context: Context) -> None:
        self._desk = context.desk
        self._editor = context.editor
        self.uuid = context.widgets.orders("Chosen answer", self.take)

    def take(self, message: str) -> None:
        """Take the settings of the button that has written a message."""
        with self._desk.lock:
            offered = offered_cures(self._desk.inspection)
            cure = offered[read_order(message, (CURE,)).index_in(offered, "examination")]
        self._editor.adjust(cure.applied, cure.words)
