"""The marks of findings in the scene: a flag at each pin, and at each step with what is open."""

import numpy as np

from stair_inspector.content.finding_list import ListedFinding, steps_marked
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Inspection
from stair_inspector.viewer.scene.nodes import NodeLabel

_FLAG, _DONE = "⚑", "✓"
_MOST_NUMBERS = 3


def marks_in_scene(findings: tuple[ListedFinding, ...], inspection: Inspection) -> tuple[Floats, list[NodeLabel]]:
    """Return the pins (k, 3), local metres, and the labels beside pins and in the middle of treads.

    A pin whose step was found is named there with the other findings of the step.
    """
    origin = np.array(inspection.scan.origin_m)
    points: list[Floats] = []
    labels: list[NodeLabel] = []
    for entry in findings:
        if entry.place_m is not None:
            points.append(np.array(entry.place_m) - origin)
            if entry.is_done or not entry.steps:
                sign = _DONE if entry.is_done else _FLAG
                labels.append((f"pin_{entry.number}", f"{sign} {entry.number}", points[-1], "bottom-left"))
    numbers = steps_marked(findings)
    for step in inspection.steps:
        own = numbers.get(step.step_id, ())
        if own:
            named = ", ".join(map(str, own[:_MOST_NUMBERS])) + (" …" if len(own) > _MOST_NUMBERS else "")
            labels.append((f"step_{step.step_id}", f"{_FLAG} {named}", step.plane.centroid, "bottom-left"))
    return np.array(points, dtype=np.float64).reshape(-1, 3), labels
