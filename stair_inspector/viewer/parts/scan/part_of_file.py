"""Reading a part of a file: a box of it, so that a building's scan is no more than its stair."""

from stair_inspector.viewer.parts.part import Context

_NAME = "crop"


class PartOfFile:
    """The folder "Part of the file" of the Scan tab."""

    def __init__(self, context: Context) -> None:
        self._editor = context.editor
        widgets = context.widgets
        with widgets.folder("Part of the file", is_open=False):
            self._editor.controls.add_text(_NAME)
            widgets.button(
                "Read this part",
                self.apply,
                is_quiet=True,
                hint="What lies outside is not read; of a COPC it is not even unpacked.",
            )

    def apply(self) -> None:
        """Read the scan with the box that is written."""
        self._editor.controls.submit_texts(_NAME)
        self._editor.submit()
