"""Groups of buttons of which one is on: viser's own do not show which."""

import viser

from stair_inspector.viewer.bridge.handles import uuid_of


class Choice:
    """A group of buttons that shows what is chosen, whoever has chosen it.

    Parameters
    ----------
    gui : viser.GuiApi
        Of one page.
    label, options, hint
        As for viser's own group.
    chosen : str
        What is on at first.
    """

    def __init__(
        self,
        gui: viser.GuiApi,
        label: str,
        options: tuple[str, ...],
        chosen: str,
        hint: str | None = None,
    ) -> None:
        self._options = options
        self.group = gui.add_button_group(label, options, hint=hint)
        self._mark = gui.add_html("")
        self.show(chosen)

    @property
    def uuid(self) -> str:
        """Identity of the control, for who else writes into it."""
        return uuid_of(self.group)

    def show(self, chosen: str) -> None:
        """Show what is chosen."""
        self._mark.content = mark_style(self.uuid, self._options.index(chosen) + 1)


def mark_style(uuid: str, place: int) -> str:
    """Return the style that fills one button of a group, the first being 1.

    A button has no mark of its own for being on; it is found by the label of its group.
    """
    button = f'.mantine-Flex-root:has(> * > * > label[for="{uuid}"]) .mantine-Flex-root > button:nth-child({place})'
    return (
        f"<style>{button} {{background:var(--mantine-primary-color-filled);"
        "color:var(--mantine-primary-color-contrast,#fff)}</style>"
    )
