"""Changing the work on a scan: settings and all else, each change undone in its turn, and what a run is asked for."""

import contextlib
import dataclasses
from collections.abc import Callable, Iterator
from typing import Unpack

from stair_inspector.errors import ConfigError
from stair_inspector.params import Params
from stair_inspector.viewer.bridge.controls import SettingControls, words_of_change
from stair_inspector.viewer.state.change import PageChange
from stair_inspector.viewer.state.keeper import Keeper, ViewOnlyError
from stair_inspector.viewer.state.work import Changes, Work


class Editor:
    """What parts of the page may change of the work; each change can be undone and is saved.

    Whoever holds both locks took the desk's first: nothing is shown while the keeper's is held.

    Parameters
    ----------
    keeper : Keeper
        Of the work.
    controls : SettingControls
        What the page shows of the settings.
    started : Params
        What :meth:`reset` goes back to.
    run : callable
        Asks for a run with the present work; the keeper's lock is held.
    changed : callable
        Told what has changed, with no lock held here.
    failed : callable
        Told why the controls, as they stand now, can not even be asked for.
    """

    def __init__(
        self,
        keeper: Keeper,
        controls: SettingControls,
        started: Params,
        run: Callable[[], None],
        changed: Callable[[PageChange], None],
        failed: Callable[[str], None],
    ) -> None:
        self._keeper = keeper
        self.controls = controls
        self.started = started
        self._run = run
        self._changed = changed
        self._failed = failed
        self.refusal: str | None = None

    @property
    def work(self) -> Work:
        """The work as it stands."""
        return self._keeper.work

    def submit(self) -> None:
        """Run with what the controls show now."""
        with self._changing():
            try:
                self._read_controls()
            except ViewOnlyError:
                raise
            except ConfigError as error:
                self.refusal = str(error)
            else:
                self.ask()
            refusal = self.refusal
        if refusal is None:
            self._changed(PageChange.HISTORY)
        else:
            self._failed(refusal)

    def adjust(self, change: Callable[[Params], Params], words: str = "") -> None:
        """Change the settings as they stand at that moment, set the controls to them, and run."""
        with self._changing():
            with contextlib.suppress(ConfigError):
                # A control that was moved just now has not been asked for yet; it must not jump back.
                self._read_controls()
            before = self.work
            params = change(before.params)
            self._go_on(dataclasses.replace(before, params=params), words or words_of_change(before.params, params)[0])
        self._changed(PageChange.WORK)

    def take_up(self, work: Work, words: str) -> None:
        """Go on with other work, all in one change, and run."""
        with self._changing():
            self._go_on(work, words)
        self._changed(PageChange.WORK)

    def edit(self, words: str, change: Callable[[Work], Changes], merge_key: str = "") -> None:
        """Change other parts of the work, as it stands at that moment, and show them.

        Changes that follow each other with the same key, as while a text is typed, are undone together.
        """
        with self._changing():
            self._keeper.change(words, merge_key, **change(self.work))
        self._changed(PageChange.WORK)

    def change(self, words: str, **fields: Unpack[Changes]) -> None:
        """Change other parts of the work, whatever they are now, and show them."""
        self.edit(words, lambda _: fields)

    def undo(self) -> None:
        """Take the last change back."""
        self._step(self._keeper.undo, can=self._keeper.history.can_undo, words="undo")

    def redo(self) -> None:
        """Do again what was taken back."""
        self._step(self._keeper.redo, can=self._keeper.history.can_redo, words="redo")

    def reset(self) -> None:
        """Go back to the settings that the server was started with."""
        self.adjust(lambda _: self.started, "reset to preset")

    def ask(self) -> None:
        """Ask for a run with the work as it stands; the keeper's lock is held."""
        self.refusal = None
        self._run()

    def _step(self, step: Callable[[], Work], *, can: bool, words: str) -> None:
        if not can:
            raise ConfigError(f"{words}: there is nothing to {words}")
        with self._changing():
            work = step()
            self.controls.load(work.params)
            self.ask()
        self._changed(PageChange.WORK)

    def _read_controls(self) -> None:
        """Take the settings that the controls show into the work; the keeper's lock is held."""
        params = self.controls.read()
        words, names = words_of_change(self.work.params, params)
        self._keeper.change(words, names, params=params)

    def _go_on(self, work: Work, words: str) -> None:
        self._keeper.replace(work, words)
        self.controls.load(work.params)
        self.ask()

    @contextlib.contextmanager
    def _changing(self) -> Iterator[None]:
        """Hold the keeper's lock; where nothing may be changed, show the work again as it is."""
        try:
            with self._keeper.lock:
                yield
        except ViewOnlyError:
            with self._keeper.lock:
                self.controls.load(self.work.params)
            self._changed(PageChange.WORK)
            raise
