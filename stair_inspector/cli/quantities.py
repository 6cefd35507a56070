"""``stair-inspector quantities``: what is measured."""

from stair_inspector.cli.arguments import is_answered
from stair_inspector.cli.output import say


def run(args: list[str]) -> int:
    """List what is measured, with units and definitions; return the exit code."""
    if not is_answered("quantities", args, "Lists what is measured of a step, of a flight and by the paper's method."):
        from stair_inspector.writers.text import quantities_text

        say(quantities_text())
    return 0
