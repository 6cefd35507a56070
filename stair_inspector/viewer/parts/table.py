"""What tables of steps and of surfaces depend on, and what a click on one of their rows asks for."""

from dataclasses import replace

from stair_inspector.errors import ConfigError
from stair_inspector.pictures.segmentation import SURFACE
from stair_inspector.viewer.bridge.markup import FLIGHT
from stair_inspector.viewer.parts.desk import Desk
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


def pick_row(desk: Desk, message: str) -> None:
    """Do what a click on a row asks for: choose its step or surface, or fold its flight."""
    words = str(message).partition(":")[0]
    if words.split(" ")[0] == FLIGHT:
        flight_id = _number(words)
        with desk.lock:
            desk.table = replace(desk.table, folded=desk.table.folded ^ {flight_id})
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
