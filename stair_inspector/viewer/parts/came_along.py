"""The line that says, after a change of scan, which settings came along, and offers the scan's own."""

from stair_inspector.errors import ConfigError
from stair_inspector.files.chosen_rules import ChosenRules, known_sets
from stair_inspector.params import SETTINGS, Params
from stair_inspector.viewer.bridge.controls import value_words
from stair_inspector.viewer.bridge.markup import LINE, order_script, press_attribute, text
from stair_inspector.viewer.parts.part import Context
from stair_inspector.viewer.parts.scan_settings import ScanSettings

_SUGGESTED, _STARTED, _KEEP = "suggested", "started", "keep"
_BUTTONS = (
    (_SUGGESTED, "As suggested", "Take what Suggest settings proposes for this scan"),
    (_STARTED, "As started", "Take the settings that the server was started with"),
    (_KEEP, "Keep", "Go on with what came along"),
)
_MOST_NAMED = 4


class CameAlong:
    """Shows what came along to the scan that is open, until it is kept or other settings are taken."""

    def __init__(self, context: Context) -> None:
        self._desk = context.desk
        self._editor = context.editor
        self._opening = context.opening
        self._settings = ScanSettings(context)
        self._html = context.widgets.html()
        self._orders = context.widgets.orders("What came along", self.take)

    def show(self) -> None:
        """Show the line, or nothing; the desk is held."""
        came, work = self._opening.came_along, self._editor.work
        content = ""
        if came is not None and came.params == work.params:
            # Rules that were chosen here did not come along.
            rules = came.rules if came.rules == work.rules else ChosenRules()
            words = came_along_words(self._editor.started, work.params, rules)
            content = came_along_html(came.source, words, self._orders)
        if self._html.content != content:
            self._html.content = content

    def take(self, message: str) -> None:
        """Do what a button of the line asks for."""
        word = str(message).partition(":")[0]
        if word == _SUGGESTED:
            self._settings.take_suggested(self._settings.suggest())
        elif word == _STARTED:
            self._settings.take_started()
        elif word != _KEEP:
            raise ConfigError(f"settings: got {word[:40]!r}; press one of the buttons")
        with self._desk.lock:
            self._opening.came_along = None
            self.show()


def came_along_words(started: Params, params: Params, rules: ChosenRules) -> tuple[str, ...]:
    """Return the settings that are not those a page starts with, and the rule set, each in words."""
    changed = [name for name in SETTINGS if started.value(name) != params.value(name)]
    words = [
        f"{SETTINGS.setting(name).called} {value_words(name, params.value(name))}" for name in changed[:_MOST_NAMED]
    ]
    if len(changed) > _MOST_NAMED:
        words.append(f"{len(changed) - _MOST_NAMED} more settings")
    if rules.set_id:
        known = known_sets(rules).get(rules.set_id)
        words.append(f"rule set {rules.set_id if known is None else known.title}")
    return tuple(words)


def came_along_html(source: str, words: tuple[str, ...], order_uuid: str) -> str:
    """Return the line with its buttons; nothing where nothing came along.

    Parameters
    ----------
    source : str
        The scan that was open before.
    words : tuple of str
        What came along.
    order_uuid : str
        Identity of the control that a button writes to.
    """
    if not words:
        return ""
    style = (
        f"border:1px solid {LINE};border-radius:4px;background:var(--mantine-color-body);color:inherit;font:inherit;"
        "font-weight:600;padding:0 8px;margin:0 0 0 4px;cursor:pointer"
    )
    buttons = "".join(
        f'<button type="button" title="{text(hint)}" {press_attribute(order_script(order_uuid, word))} '
        f'style="{style}">{text(label)}</button>'
        for word, label, hint in _BUTTONS
    )
    return (
        '<div data-testid="came-along" role="status" style="font-size:12px;line-height:1.4;margin:0 9px 7px;'
        f"padding:3px 6px;border-left:3px solid {LINE};background:var(--mantine-color-default-hover);"
        f'overflow-wrap:anywhere"><b>Came along from {text(source)}:</b> {text(", ".join(words))} '
        f'<span style="white-space:nowrap">{buttons}</span></div>'
    )
