"""What makes a slider re-run only the stages that it must."""

import time
from collections.abc import Callable
from typing import Any, TypeVar, cast

T = TypeVar("T")


class Memo:
    """One slot per stage: a stage whose inputs and settings are those of its last run is not run again.

    Inputs are compared by identity where they hold arrays (which have no ``==``) and by value where they are settings.
    ``heavy`` runs what takes seconds, for example in another process; ``on_stage`` is told each stage's name.
    """

    def __init__(self, heavy: Callable[..., Any] | None = None, on_stage: Callable[[str], None] | None = None) -> None:
        self._slots: dict[str, tuple[tuple[object, ...], Any]] = {}
        self._heavy = heavy
        self._on_stage = on_stage
        self.timings_s: dict[str, float] = {}

    def run(self, stage: str, function: Callable[..., T], *inputs: object, heavy: bool = False) -> T:
        """Return ``function(*inputs)``, from the stage's slot if its inputs have not changed."""
        slot = self._slots.get(stage)
        if slot is not None and slot[0] == inputs:
            return cast(T, slot[1])
        if self._on_stage is not None:
            self._on_stage(stage)
        began = time.perf_counter()
        result = self._heavy(function, *inputs) if heavy and self._heavy is not None else function(*inputs)
        self.timings_s[stage] = self.timings_s.get(stage, 0.0) + time.perf_counter() - began
        self._slots[stage] = (inputs, result)
        return result
