"""The table of steps with its choice of columns, on each tab that has one; all of them show the same."""

from stair_inspector.errors import ConfigError, one_of
from stair_inspector.pictures.segmentation import SURFACE
from stair_inspector.viewer.bridge.markup import FLIGHT
from stair_inspector.viewer.parts.desk import Desk
from stair_inspector.viewer.parts.part import Context
from stair_inspector.viewer.parts.step_table_html import COLUMNS, columns_of, table_html
from stair_inspector.viewer.state.change import PageChange

NO_STEP = "none"
TABLE_CHANGES = frozenset(
    {
        PageChange.WORK,
        PageChange.RESULT,
        PageChange.SCAN,
        PageChange.COLORS,
        PageChange.SELECTION,
        PageChange.TABLE,
        PageChange.UNIT,
        PageChange.THEME,
        PageChange.SETTLED,
    }
)
"""What a table depends on; of the work, the rules whose limits mark steps."""


class StepTable:
    """A table of steps; its rows write to the control ``uuid``.

    Parameters
    ----------
    context : Context
        Of the page.
    prefix : str
        Before the names by which the page's pieces are told apart, where there is another table on it.
    """

    def __init__(self, context: Context, prefix: str = "") -> None:
        self._desk = context.desk
        self._prefix = prefix
        names = tuple(columns.capitalize() for columns in COLUMNS)
        self.columns = context.widgets.choice(
            "Table",
            names,
            names[0],
            self.set_columns,
            hint="The survey's values with their uncertainties, or the paper's.",
            is_visible=False,
        )
        self.html = context.widgets.html()
        self.uuid = context.widgets.orders("Picked row", lambda message: pick_row(context.desk, message))

    def set_columns(self, option: str) -> None:
        """Show the survey's or the paper's columns."""
        columns = one_of(str(option).lower(), COLUMNS, "table")
        with self._desk.lock:
            self._desk.columns = columns
            self._desk.changed(PageChange.TABLE)

    def show(self) -> None:
        """Show the rows, and the choice of columns where there is one."""
        desk = self._desk
        inspection = desk.marked
        columns = columns_of(inspection, desk.columns)
        content = table_html(
            inspection,
            desk.palette,
            desk.selected,
            self.uuid,
            columns,
            desk.unit,
            folded=desk.folded,
            marks=desk.marks,
        )
        self.columns.group.visible = inspection is not None and inspection.params.method == "survey"
        self.columns.show(columns.capitalize())
        # Tables may be on the page at the same time, and each has names of its own.
        self.html.content = content.replace('data-testid="', f'data-testid="{self._prefix}')


def pick_row(desk: Desk, message: str) -> None:
    """Do what a click on a row asks for: choose its step or surface, or fold its flight."""
    words = str(message).partition(":")[0]
    if words.split(" ")[0] == FLIGHT:
        flight_id = _number(words)
        with desk.lock:
            desk.folded ^= {flight_id}
            desk.changed(PageChange.TABLE)
        return
    chosen = read_choice(words)
    # A second click on the same row puts the selection away.
    desk.select(*((None, None) if chosen == (desk.selected, desk.selected_patch) else chosen))


def read_choice(value: object) -> tuple[int | None, int | None]:
    """Return the step or the surface that an option of the menu or a row names; neither for none."""
    words = str(value).split(" ")
    if words == [NO_STEP]:
        return None, None
    number = _number(value)
    return (None, number) if words[0] == SURFACE else (number, None)


def _number(value: object) -> int:
    try:
        return int(str(value).split(" ")[-1])
    except ValueError as error:
        raise ConfigError(f"step: got {str(value)[:40]!r}; give a number") from error
