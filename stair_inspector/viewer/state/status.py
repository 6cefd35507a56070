"""What is going on for one page: what is computed or made for it, and why the last request came to nothing."""

from dataclasses import dataclass

from stair_inspector.viewer.compute.runs import Progress


@dataclass(slots=True)
class PageStatus:
    """What one line of the page says.

    Attributes
    ----------
    error : str, optional
        Why the last request gave no result.
    waiting : str, optional
        What is begun and tells no progress yet.
    running, made : Progress, optional
        What a run and what the making of a file told last.
    """

    error: str | None = None
    waiting: str | None = None
    running: Progress | None = None
    made: Progress | None = None

    def begin(self, words: str) -> None:
        """Forget the last result's runs: another scan is opened."""
        self.error = self.running = None
        self.waiting = words

    @property
    def is_behind(self) -> bool:
        """Whether the last good result is not that of the present settings, as far as is told."""
        return self.error is not None or self.running is not None

    @property
    def going_on(self) -> Progress | None:
        """What is made or computed now, with how far it is."""
        return self.made or self.running
