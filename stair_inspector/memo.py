"""What makes a slider re-run only the stages that it must."""

import dataclasses
import time
from collections.abc import Callable
from functools import partial
from typing import Any, ParamSpec, TypeVar, cast

import numpy as np

P = ParamSpec("P")
T = TypeVar("T")


class Memo:
    """One slot per stage: a stage whose inputs and settings are those of its last run is not run again.

    Inputs are compared by identity where they hold arrays (which have no ``==``) and by value where they are settings.
    A stage that gives the same values as the last time gives the same object: what follows it need not run again.
    ``heavy(function, *inputs)`` runs what takes seconds, for example in another process; ``on_stage`` is told each
    stage's name. The type checker holds the inputs against the stage's own parameters: swapped ones are an error.
    """

    def __init__(self, heavy: Callable[..., Any] | None = None, on_stage: Callable[[str], None] | None = None) -> None:
        self._slots: dict[str, tuple[tuple[object, ...], Any]] = {}
        self._heavy = heavy
        self._on_stage = on_stage
        self.timings_s: dict[str, float] = {}

    def run(self, stage: str, function: Callable[P, T], *inputs: P.args, **named: P.kwargs) -> T:
        """Return ``function(*inputs)``, from the stage's slot if its inputs have not changed."""
        return self._kept(stage, partial(function, *inputs, **named), (*inputs, *named.items()))

    def run_heavy(self, stage: str, function: Callable[P, T], *inputs: P.args, **named: P.kwargs) -> T:
        """Do the same for a stage that takes seconds, through ``heavy`` if there is one."""
        if self._heavy is None:
            return self.run(stage, function, *inputs, **named)
        make: Callable[[], T] = partial(self._heavy, function, *inputs, **named)
        return self._kept(stage, make, (*inputs, *named.items()))

    def result(self, stage: str) -> Any:
        """Return what a stage gave when it last ran.

        Raises
        ------
        KeyError
            It has not run.
        """
        return self._slots[stage][1]

    def _kept(self, stage: str, make: Callable[[], T], inputs: tuple[object, ...]) -> T:
        slot = self._slots.get(stage)
        if slot is not None and slot[0] == inputs:
            return cast(T, slot[1])
        if self._on_stage is not None:
            self._on_stage(stage)
        began = time.perf_counter()
        result = make()
        if slot is not None and _is_same(slot[1], result):
            result = slot[1]
        self.timings_s[stage] = self.timings_s.get(stage, 0.0) + time.perf_counter() - began
        self._slots[stage] = (inputs, result)
        return result


def _is_same(one: object, other: object) -> bool:
    """Return whether two results hold the same values, in arrays, tuples, dictionaries and dataclasses too."""
    if one is other:
        return True
    if type(one) is not type(other):
        return False
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return one.dtype == other.dtype and bool(np.array_equal(one, other))
    if isinstance(one, tuple | list) and isinstance(other, tuple | list):
        return len(one) == len(other) and all(map(_is_same, one, other))
    if isinstance(one, dict) and isinstance(other, dict):
        return list(one) == list(other) and all(map(_is_same, one.values(), other.values()))
    if dataclasses.is_dataclass(one):
        return all(_is_same(getattr(one, each.name), getattr(other, each.name)) for each in dataclasses.fields(one))
    return bool(one == other)
