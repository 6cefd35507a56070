"""What can change on a page: parts say on which of these they depend, and show themselves when one of them has."""

from enum import Enum, auto


class PageChange(Enum):
    """A kind of change; several may come together."""

    WORK = auto()
    """Anything of the work on a scan but its settings: also another work, as after undo or with another scan."""
    HISTORY = auto()
    """What can be undone, as after a slider was moved; the rest of the work is as it was."""
    RESULT = auto()
    """Another result is shown, or none."""
    SCAN = auto()
    """Another scan is shown, the same one turned upright anew, or none; always with ``RESULT``."""
    CLOUD = auto()
    """Other points of the same scan are drawn."""
    COLORS = auto()
    """The same result is drawn in other colours, or with its rejected surfaces."""
    COMPARED = auto()
    """What changed against a second scan is known, or no longer, or why it is not."""
    SELECTION = auto()
    """Another step or surface is chosen, or none."""
    TABLE = auto()
    """The tables have other columns, or a flight is folded."""
    UNIT = auto()
    """Lengths are written in another unit."""
    THEME = auto()
    """The page is light or dark."""
    MODE = auto()
    """The raw cloud is shown, the steps, or both."""
    LEGEND = auto()
    """Lines of another kind are drawn, or no longer."""
    SETTLED = auto()
    """It was found which values hang on the settings."""
    REST = auto()
    """No other result is asked for than the one that is shown: what takes long can be made of it."""
    STATUS = auto()
    """What is being computed, made or saved, or why it was not."""
