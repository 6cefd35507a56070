"""Which control and which key calls what: the one place where the parts of a page are tied together."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from stair_inspector.viewer.bridge.shortcuts import Command, add_commands
from stair_inspector.viewer.parts.checks.tab import ChecksActions
from stair_inspector.viewer.parts.export.report_tab import DOCUMENTS, DRAWINGS, EVERYTHING, ReportActions
from stair_inspector.viewer.parts.export.tab import ExportActions
from stair_inspector.viewer.parts.panel import Actions
from stair_inspector.viewer.parts.scan.tab import ScanActions
from stair_inspector.viewer.parts.steps.tab import StepsActions
from stair_inspector.viewer.parts.tune.tab import TuneActions

if TYPE_CHECKING:
    from stair_inspector.viewer.page import Session


def actions_of(session: "Session") -> Actions:
    """Return what the panel calls, each guarded. The parts are looked up when called: the panel is made first."""
    guard = session.notices.guard

    def to(find: Callable[[], Callable[..., None]]) -> Callable[..., None]:
        return guard(lambda *values: find()(*values))

    return Actions(
        scan=ScanActions(
            on_scan=to(lambda: session.choose_scan),
            on_refresh=to(lambda: session.opening.look_for_scans),
            on_upload=to(lambda: session.take_upload),
            on_up_tool=to(lambda: session.upright.start),
            on_region_tool=to(lambda: session.region.use_tool),
            on_region_shown=to(lambda: session.region.set_shown),
            on_region_corner=to(lambda: session.region.read_numbers),
            on_region_apply=to(lambda: session.region.apply),
            on_color=to(lambda: _colouring(session, session.looking.set_color)),
            on_shading=to(lambda: _colouring(session, session.looking.set_shading)),
            on_density=to(lambda: session.set_density),
            on_point_size=to(lambda: session.looking.set_point_size),
        ),
        tune=TuneActions(
            on_preset=to(lambda: session.tuning.take_preset),
            on_reset=to(lambda: session.reset),
            on_save_preset=to(lambda: session.tuning.save_preset),
            on_load_preset=to(lambda: session.tuning.load_preset),
            on_undo=to(lambda: session.undo),
            on_redo=to(lambda: session.redo),
            on_suggest=to(lambda: session.tuning.suggest),
            on_take_suggestion=to(lambda: session.tuning.take_suggestion),
            on_keep_run=to(lambda: session.comparing.keep),
            on_compare=to(lambda: session.comparing.compare_with),
            on_compare_to=to(lambda: session.comparing.compare_to),
            on_take_run=to(lambda: session.comparing.take_settings),
            on_delete_run=to(lambda: session.comparing.forget),
            on_sweep=to(lambda: session.comparing.sweep),
            on_stop_sweep=to(lambda: session.comparing.stop_sweep),
            on_quantity=to(lambda: session.comparing.show_sweep),
        ),
        steps=StepsActions(
            on_select=to(lambda: session.results.choose),
            on_columns=to(lambda: session.results.set_columns),
            on_rejected=to(lambda: session.set_rejected),
            on_mark=to(lambda: session.deciding.mark),
            on_texts=to(lambda: session.deciding.submit_texts),
            on_clear_overrules=to(lambda: session.deciding.clear),
        ),
        checks=ChecksActions(
            on_rules=to(lambda: session.checking.choose),
            on_overlay=to(lambda: session.checking.choose_overlay),
            on_decision=to(lambda: session.checking.choose_decision),
            on_rule=to(lambda: session.checking.choose_rule),
            on_edit=to(lambda: session.checking.edit),
            on_revert=to(lambda: session.checking.revert),
            on_revert_all=to(lambda: session.checking.revert_all),
            on_own_file=to(lambda: session.checking.take_file),
            on_copy=to(lambda: session.checking.save_copy),
            on_forget_file=to(lambda: session.checking.forget_file),
        ),
        export=ExportActions(
            on_title=to(lambda: session.exporting.set_title),
            on_download=to(lambda: session.exporting.download),
            on_open_project=to(lambda: session.exporting.open_project),
            report=ReportActions(
                on_make=to(lambda: session.reporting.make),
                on_text=to(lambda: session.reporting.set_text),
                on_paper=to(lambda: session.reporting.set_paper),
                on_add_reading=to(lambda: session.reporting.add_reading),
                on_order=to(lambda: session.reporting.obey),
                on_logo=to(lambda: session.reporting.take_logo),
                on_photo=to(lambda: session.reporting.take_photo),
                on_remove_logo=to(lambda: session.reporting.remove_logo),
            ),
        ),
        on_settings=to(lambda: session.submit),
        on_pick=to(lambda: session.pick),
        on_cancel=to(lambda: session.cancel),
        on_run=to(lambda: session.submit),
        on_unit=to(lambda: session.set_unit),
        on_theme=to(lambda: session.set_theme),
        on_help=to(lambda: lambda: session.help.switch(commands_of(session))),
    )


def commands_of(session: "Session") -> tuple[Command, ...]:
    """Return every command with its key."""
    guard = session.notices.guard
    views, section, measure = session.toolbar.views, session.toolbar.section, session.toolbar.measure

    def with_value(action: Callable[[Any], None], value: Any) -> Callable[[], None]:
        return guard(lambda: action(value))

    return (
        Command("Next step up", with_value(session.results.move, 1), "arrowup"),
        Command("Next step down", with_value(session.results.move, -1), "arrowdown"),
        Command("Next step outside a limit", guard(session.checking.next_outside), "N"),
        Command("Look at the chosen step", guard(views.look_at_step), "F"),
        Command("Home view", with_value(views.set_view, "Home"), "1"),
        Command("Front view", with_value(views.set_view, "Front"), "2"),
        Command("Side view", with_value(views.set_view, "Side"), "3"),
        Command("Top view", with_value(views.set_view, "Top"), "4"),
        Command("View along the stair", with_value(views.set_view, "Along"), "5"),
        Command("Orthographic look", guard(views.switch_ortho), "O"),
        Command("Raw cloud", with_value(views.set_mode, "Raw"), "7"),
        Command("Coloured steps", with_value(views.set_mode, "Segmented"), "8"),
        Command("Raw and steps side by side", with_value(views.set_mode, "Side by side"), "9"),
        Command("Section on or off", guard(section.switch), "X"),
        Command("Measure: off, point, distance", guard(measure.next_mode), "M"),
        Command("Keep this view", guard(views.keep), "V"),
        Command("Undo", guard(session.undo), "Z", "cmd/ctrl"),
        Command("Redo", guard(session.redo), "Z", "cmd/ctrl+shift"),
        Command("Millimetres or inches", guard(lambda: _other_unit(session)), "U"),
        Command("Light or dark theme", guard(lambda: _other_theme(session)), "T"),
        Command("Put the selection or tool away", guard(lambda: _escape(session)), "escape"),
        Command("This help", guard(lambda: session.help.switch(commands_of(session))), "H"),
        Command("Download CSV", with_value(session.exporting.download, "CSV")),
        Command("Download JSON", with_value(session.exporting.download, "JSON")),
        Command("Screenshot", with_value(session.exporting.download, "Screenshot PNG"), "P"),
        Command("Download all standard views", with_value(session.exporting.download, "All views ZIP")),
        Command("Report: everything in one ZIP", with_value(session.reporting.make, EVERYTHING)),
        *(Command(f"Report: {kind}", with_value(session.reporting.make, kind)) for kind in (*DOCUMENTS, *DRAWINGS)),
        Command("Download the project", with_value(session.exporting.download, "Project file")),
        Command("Suggest settings", guard(session.tuning.suggest)),
        Command("Run again", guard(session.submit), "R"),
        Command("Reset the settings", guard(session.reset), "R", "shift"),
        Command("Cancel what is being computed", guard(session.cancel)),
    )


def add_keys(session: "Session") -> None:
    """Register the commands on the page."""
    add_commands(session.desk.client.gui, commands_of(session))


def _colouring(session: "Session", choose: Callable[[Any], None]) -> Callable[[Any], None]:
    def chosen(value: Any) -> None:
        with session.desk.lock:
            choose(value)
            session.redraw()

    return chosen


def _other_unit(session: "Session") -> None:
    session.set_unit("in" if session.desk.unit == "mm" else "mm")


def _other_theme(session: "Session") -> None:
    session.panel.dark.value = not session.desk.is_dark
    session.set_theme(not session.desk.is_dark)


def _escape(session: "Session") -> None:
    if session.help.close() or session.toolbar.section.put_card_away():
        return
    if session.toolbar.measure.step_back():
        return
    session.upright.stop()
    session.results.select(None)
