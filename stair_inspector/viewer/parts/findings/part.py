"""The Findings tab: one list of what the program found and what the inspector pins, and their marks in the scene."""

import numpy as np
import viser

from stair_inspector.content.finding_list import ListedFinding, list_findings
from stair_inspector.errors import ConfigError, one_of
from stair_inspector.viewer.bridge.markup import RowOrder, list_key, read_order
from stair_inspector.viewer.bridge.shortcuts import Command
from stair_inspector.viewer.parts.findings.form import FindingForm
from stair_inspector.viewer.parts.findings.list_html import FINDING_ORDERS, findings_html, keys_of
from stair_inspector.viewer.parts.findings.marks import marks_in_scene
from stair_inspector.viewer.parts.part import Context, PagePart
from stair_inspector.viewer.scene.framing import near_pose
from stair_inspector.viewer.state.change import PageChange

_FILTERS = ("Open", "All")
_MOST_LISTS = 4
"""So many lists back a row is still known."""


class FindingsPart(PagePart):
    """Lists findings; a row looks at its own, and its buttons change it so that it can be undone."""

    title = "Findings"
    icon = viser.Icon.FLAG
    depends_on = frozenset(
        {
            PageChange.WORK,
            PageChange.RESULT,
            PageChange.SCAN,
            PageChange.CLOUD,
            PageChange.SELECTION,
            PageChange.SETTLED,
        }
    )

    def __init__(self, context: Context) -> None:
        self._desk = context.desk
        self._look = context.look
        self._editor = context.editor
        self._judge = context.judge
        self._filter = _FILTERS[0]
        self._key = ""
        self.listed: tuple[ListedFinding, ...] = ()
        self._before: tuple[tuple[str, ...], ...] = ()
        widgets = context.widgets
        self._choice = widgets.choice(
            "List", _FILTERS, self._filter, self.set_filter, hint="Those that are open, or also those that are done."
        )
        self.list = widgets.html()
        self._orders = widgets.orders("Finding order", self.obey)
        with widgets.folder("Pin or remark"):
            self.form = FindingForm(context, self.chosen, self.leave)
        self._marks = widgets.checkbox(
            "Marks in the scene", is_on=True, hint="⚑ with its number; not in pictures.", on_change=self.set_marks
        )

    def show(self, what: frozenset[PageChange]) -> None:
        """List what is found now, and draw its marks."""
        if what != {PageChange.SELECTION}:
            findings = self._editor.work.findings
            before, self.listed = self.listed, list_findings(self._desk.marked, self._judge.check, findings)
            if keys_of(before) != keys_of(self.listed):
                self._before = (keys_of(before), *self._before[: _MOST_LISTS - 1])
            if self.chosen() is None:
                self._key = ""
            self._draw()
        self._show_list()
        self.form.show()

    def put_away(self) -> bool:
        """Give up the point that is picked, or leave the finding that was chosen."""
        if self.form.stop_picking():
            return True
        had = bool(self._key)
        self.leave()
        return had

    def commands(self) -> tuple[Command, ...]:
        """Return the keys of the list."""
        return (
            Command("Pick a point for a pin", self.start_pin, "I"),
            Command("Next open finding", self.next_open, "J"),
            Command("Set the pin, or keep what is written of a finding", self.form.submit),
        )

    def chosen(self) -> ListedFinding | None:
        """Return the finding that was chosen, None for none."""
        return next((entry for entry in self.listed if entry.key == self._key), None) if self._key else None

    def leave(self) -> None:
        """Choose no finding: what is written next is a new pin."""
        self._choose("")

    def start_pin(self) -> None:
        """Begin a new pin at a point."""
        self.leave()
        self.form.start_picking()

    def set_filter(self, option: str) -> None:
        """List those that are open, or all."""
        with self._desk.lock:
            self._filter = one_of(option, _FILTERS, "list of findings")
            self._choice.show(self._filter)
            self._show_list()

    def set_marks(self, _: bool) -> None:
        """Show or hide the marks in the scene."""
        with self._desk.lock:
            self._draw()

    def next_open(self) -> None:
        """Choose the next open finding, after the last one the first."""
        with self._desk.lock:
            open_ones = [entry for entry in self.listed if not entry.is_done]
            if not open_ones:
                raise ConfigError("next open finding: there is none")
            here = self.chosen()
            after = [entry for entry in open_ones if here is not None and entry.number > here.number]
            self._look_at((after or open_ones)[0])

    def obey(self, message: str) -> None:
        """Do what a row or one of its buttons asks for."""
        order = read_order(message, FINDING_ORDERS)
        with self._desk.lock:
            entry = self._entry_of(order)
            if order.word == "show":
                self._look_at(entry)
            elif order.word == "done":
                self.form.set_done(entry, not entry.is_done)
            else:
                self._editor.edit(
                    f"deleted finding {entry.number}", lambda work: {"findings": work.findings.without(entry.key)}
                )

    def _entry_of(self, order: RowOrder) -> ListedFinding:
        """Return the finding of a row, also of a list that has just been replaced, as long as it is still found.

        What hangs on the settings is found a moment after a result, while a row may be on its way.
        """
        for keys in self._before:
            if order.key == list_key(keys) and 1 <= order.number <= len(keys):
                same = [entry for entry in self.listed if entry.key == keys[order.number - 1]]
                if same:
                    return same[0]
        return self.listed[order.index_in(keys_of(self.listed), "findings")]

    def _look_at(self, entry: ListedFinding) -> None:
        self._choose(entry.key)
        if entry.steps:
            self._desk.select(entry.steps[0])
        elif entry.place_m is not None and self._desk.inspection is not None:
            fov_rad = self._look.fov_rad
            places = self._desk.to_view(np.array([entry.place_m]))
            self._look.go_to(near_pose(self._look.pose(), places, fov_rad), fov_rad)

    def _choose(self, key: str) -> None:
        with self._desk.lock, self._desk.client.atomic():
            self._key = key
            self._show_list()
            self.form.show()

    def _show_list(self) -> None:
        said_of = frozenset(each.key for each in self._editor.work.findings.decisions)
        self.list.content = findings_html(
            self.listed, self._key, self._orders, with_done=self._filter != _FILTERS[0], said_of=said_of
        )

    def _draw(self) -> None:
        inspection = self._desk.inspection
        if inspection is not None:
            listed = self.listed if self._marks.value else ()
            self._desk.stage.show_findings(*marks_in_scene(listed, inspection))
