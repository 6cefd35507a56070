"""What was not observed of a step, and why is a value missing?"""

from collections.abc import Sequence

from stair_inspector.model import Chain, Note, Step, StepShape


def notes_of_unobserved(chain: Chain, shapes: tuple[StepShape, ...], steps: Sequence[Step]) -> list[Note]:
    """Say of every step what was not observed, and why a value is null."""
    notes = []
    for k, (shape, step) in enumerate(zip(shapes, steps, strict=True)):
        here = step.step_id
        if chain.n_missing[k]:
            count = chain.n_missing[k]
            text = "a tread is" if count == 1 else f"{count} treads are"
            below, lost = f"step {here - 1}", f"neither the rise to step {here} nor the going of step {here - 1} is"
            if k == 0:
                below, lost = "the floor or landing", f"the rise to step {here} is not"
            message = f"{text} missing or not seen between {below} and step {here}: {lost} defined"
            notes.append(Note("tread_missing", "survey", message, here))
        elif step.rise_m is None:
            message = f"step {here} has no rise: no floor or landing was seen a riser below it"
            notes.append(Note("rise_unobserved", "survey", message, here))
        if not shape.front.support:
            message = f"the nosing of step {here} was not seen, only the rim of its surface: its place is uncertain"
            notes.append(Note("nosing_unobserved", "survey", message, here))
        if shape.back is None and shape.back_limits is not None:
            message = (
                f"the back of step {here} is hidden, as under the nosing above it: its depth is the middle of what is "
                "possible"
            )
            notes.append(Note("back_hidden", "survey", message, here))
        elif shape.back is None:
            notes.append(Note("back_unobserved", "survey", f"the back edge of step {here} was not seen", here))
        if not min(shape.left.support, shape.right.support):
            message = f"a side of step {here} was not seen, or ends inside those of the others: its width is uncertain"
            notes.append(Note("side_unobserved", "survey", message, here))
    return notes
