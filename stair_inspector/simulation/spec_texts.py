"""How are faults and places of a simulated stair written? Errors by step, lists of steps, an offset."""

import math

from stair_inspector.errors import ConfigError

_LARGEST_OFFSET_M = 1e8


def parse_errors(name: str, text: str, last_step: int, largest: float) -> dict[int, float]:
    """Return the errors that ``text`` gives to steps, by step.

    Parameters
    ----------
    name : str
        Setting, for the message.
    text : str
        Pairs ``step:value`` separated by commas; empty for none.
    last_step : int
        Highest step that may be named; the lowest is 1.
    largest : float
        Largest magnitude of a value, in the setting's unit.

    Raises
    ------
    ConfigError
        Not of that form, no such step, a step named twice, or a value too large.

    Examples
    --------
    >>> parse_errors("stair.rise_errors_m", "5:+0.015, 6:-0.015", 10, 0.3)
    {5: 0.015, 6: -0.015}
    """
    errors: dict[int, float] = {}
    for pair in text.split(",") if text.strip() else ():
        step_text, _, value_text = pair.partition(":")
        try:
            step, value = int(step_text), float(value_text)
        except ValueError:
            raise ConfigError(f"{name}: got {text!r}; give pairs step:value such as 5:+0.015,6:-0.015") from None
        if not 1 <= step <= last_step:
            known = f"steps 1 to {last_step}" if last_step >= 1 else "no step"
            raise ConfigError(f"{name}: got step {step}; this stair has {known} to which it applies")
        if step in errors:
            raise ConfigError(f"{name}: step {step} is given twice; give it once")
        if not abs(value) <= largest:
            raise ConfigError(f"{name}: got {value:g} for step {step}; give a value from {-largest:g} to {largest:g}")
        errors[step] = value
    return errors


def parse_steps(name: str, text: str, last_step: int) -> tuple[int, ...]:
    """Return the steps that ``text`` lists, in order.

    Parameters
    ----------
    name : str
        Setting, for the message.
    text : str
        Steps separated by commas; empty for none.
    last_step : int
        Highest step that may be named; the lowest is 1.

    Raises
    ------
    ConfigError
        Not of that form, or no such step.

    Examples
    --------
    >>> parse_steps("stair.missing_treads", "6, 5", 9)
    (5, 6)
    """
    try:
        steps = {int(step) for step in text.split(",")} if text.strip() else set()
    except ValueError:
        raise ConfigError(f"{name}: got {text!r}; give steps such as 5,6") from None
    for step in sorted(steps):
        if not 1 <= step <= last_step:
            known = f"steps 1 to {last_step}" if last_step >= 1 else "no step"
            raise ConfigError(f"{name}: got step {step}; this stair has {known} to which it applies")
    return tuple(sorted(steps))


def parse_offset(text: str) -> tuple[float, float, float]:
    """Return the three numbers of an offset, metres.

    Raises
    ------
    ConfigError
        Not three finite numbers, or one beyond 1e8.

    Examples
    --------
    >>> parse_offset("691000, 5335000.5, 520")
    (691000.0, 5335000.5, 520.0)
    """
    try:
        parts = [float(part) for part in text.split(",")]
    except ValueError:
        parts = []
    if len(parts) != 3 or not all(math.isfinite(part) for part in parts):
        raise ConfigError(f"stair.offset_m: got {text!r}; give three numbers such as 691000,5335000,520")
    if max(abs(part) for part in parts) > _LARGEST_OFFSET_M:
        raise ConfigError(
            f"stair.offset_m: got {text!r}; give numbers within {_LARGEST_OFFSET_M:g} m, as in any map grid"
        )
    return (parts[0], parts[1], parts[2])
