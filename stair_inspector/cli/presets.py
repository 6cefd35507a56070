"""``stair-inspector presets``: the presets that come with the program."""

from stair_inspector.cli.arguments import is_answered
from stair_inspector.files.settings import list_presets


def run(args: list[str]) -> int:
    """List the presets with their descriptions; return the exit code."""
    if is_answered("presets", args, "Lists the presets that come with the program."):
        return 0
    presets = list_presets()
    width = max(len(preset.name) for preset in presets)
    for preset in presets:
        print(f"{preset.name:<{width}}  {preset.description}")
    return 0
