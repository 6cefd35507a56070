"""The Export tab: the title, the result's files, the report, pictures, and the project."""

from functools import partial

import viser

from stair_inspector.content.texts import require_text
from stair_inspector.errors import ConfigError
from stair_inspector.files.project_files import parse_project
from stair_inspector.files.projects import check_scan
from stair_inspector.viewer.bridge.markup import DIM, text
from stair_inspector.viewer.bridge.shortcuts import Command
from stair_inspector.viewer.bridge.widgets import File
from stair_inspector.viewer.parts.export.files import Downloads
from stair_inspector.viewer.parts.export.report import DOCUMENTS, DRAWINGS, EVERYTHING
from stair_inspector.viewer.parts.export.report_form import ReportForm
from stair_inspector.viewer.parts.part import Context, PagePart
from stair_inspector.viewer.scene.step_marks import tone_css
from stair_inspector.viewer.state.change import PageChange
from stair_inspector.viewer.state.work import work_of

_LONGEST_TITLE = 200
_COMMANDS = (
    ("CSV", ""),
    ("JSON", ""),
    ("BCF", ""),
    ("Screenshot PNG", "P"),
    ("All views ZIP", ""),
    ("Project file", ""),
)


class ExportPart(PagePart):
    """What an inspector takes away, and the project that is taken up again."""

    title = "Export"
    icon = viser.Icon.DOWNLOAD
    depends_on = frozenset({PageChange.WORK, PageChange.RESULT, PageChange.UNIT, PageChange.STATUS})

    def __init__(self, context: Context) -> None:
        self._desk = context.desk
        self._keeper = context.keeper
        self._editor = context.editor
        widgets = context.widgets
        widgets.html(
            '<div style="font-size:12px;padding:2px 9px 6px">Files hold the numbers and settings of the result shown, '
            "not of a slider that is still moving.</div>"
        )
        self.title_field = widgets.text(
            "Title",
            hint="Of the inspection; it stands on pictures and in the project.",
            on_change=self.set_title,
        )
        self.report = ReportForm(context)
        self.downloads = Downloads(context)
        self.downloads.add_files()
        self.downloads.add_pictures()
        with widgets.folder("Project"):
            self.saved = widgets.html()
            self.downloads.add_project()
            self.open = widgets.upload(
                "Open project",
                ".json",
                self.open_project,
                icon=viser.Icon.FOLDER_OPEN,
                hint="Of this same scan.",
            )

    def show(self, what: frozenset[PageChange]) -> None:
        """Show what is kept of what was written, and whether it is saved."""
        if PageChange.WORK in what:
            self.title_field.value = self._editor.work.title
            self.report.show()
        elif what & {PageChange.RESULT, PageChange.UNIT}:
            self.report.show_readings()
        if what & {PageChange.WORK, PageChange.STATUS}:
            self._show_saved()

    def commands(self) -> tuple[Command, ...]:
        """Return the downloads, for the palette."""
        words = {"Screenshot PNG": "Screenshot", "All views ZIP": "Download all standard views"}
        words["Project file"] = "Download the project"
        download, make = self.downloads.download, self.report.maker.make
        return (
            *(Command(words.get(kind, f"Download {kind}"), partial(download, kind), key) for kind, key in _COMMANDS),
            Command("Report: everything in one ZIP", partial(make, EVERYTHING)),
            *(Command(f"Report: {kind}", partial(make, kind)) for kind in (*DOCUMENTS, *DRAWINGS)),
        )

    def set_title(self, title: str) -> None:
        """Name the inspection."""
        try:
            words = require_text(" ".join(str(title).split())[:_LONGEST_TITLE], "Title")
        except ConfigError:
            self.title_field.value = self._editor.work.title
            raise
        if words != self._editor.work.title:
            # What is typed in one go is one change.
            self._editor.edit("title", lambda _: {"title": words}, "title")

    def open_project(self, file: File) -> None:
        """Take up a project from a file: its settings, overrules, measurements, views and names; can be undone."""
        project = parse_project(file.content, str(file.name)[:80])
        with self._desk.lock:
            shown = self._desk.result("open project")
            check_scan(project, shown.scan.sha256, shown.label, str(file.name)[:80])
            self._editor.take_up(work_of(project), f"opened {str(file.name)[:40]}")

    def _show_saved(self) -> None:
        """Say where the project is saved, or why it is not."""
        keeper = self._keeper
        path, saved_at = keeper.path, keeper.saved_at
        if keeper.is_view_only:
            words = "This page saves nothing"
        elif keeper.error:
            words = f'<span style="color:{tone_css("bad")}">Not saved: {text(keeper.error)}</span>'
        elif path is not None and saved_at is not None:
            words = f"Saved at {saved_at.strftime('%H:%M:%S')} in {text(path.name)}"
        elif path is not None:
            words = f"Every change is saved in {text(path.name)}"
        else:
            words = "Kept until the server ends; download the project to keep it longer"
        self.saved.content = (
            f'<div data-testid="saved" style="font-size:12px;color:{DIM};padding:2px 9px 6px;overflow-wrap:anywhere">'
            f"{words}.</div>"
        )
