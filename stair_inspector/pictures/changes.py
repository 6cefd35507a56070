"""What changed between two scans in colour: how far the later surface of each tread lies off the earlier one."""

import numpy as np

from stair_inspector.content.segmented_points import labels_at
from stair_inspector.geometry.arrays import Floats, Ints
from stair_inspector.model import ComparedScan, Inspection, ScanComparison, TreadDeviations
from stair_inspector.pictures.legends import Legend
from stair_inspector.pictures.ramps import NOT_COLORED, signed_limit, signed_ramp


def change_limit(found: ScanComparison) -> float:
    """Return a round distance at which nearly all deviations lie within the scale, metres."""
    maps = [step.deviations.deviation_m.ravel() for step in found.steps if step.deviations is not None]
    return signed_limit(np.concatenate(maps) if maps else np.zeros(0))


def change_legend(limit_m: float, others: str) -> Legend:
    """Return the legend of the deviations, millimetres, the same to both sides; ``others`` says what is left grey."""
    return Legend(
        "later surface against the earlier one [mm]: − lower, + higher; larger ones take the end's colour",
        ((NOT_COLORED, others),),
        signed_ramp(limit_m),
    )


def deviations_at(compared: ComparedScan, inspection: Inspection, points: Floats, rows: Ints) -> Floats:
    """Return the deviation (m,) of the tread at points (m, 3), which stand in these rows of the scan at hand, metres.

    Parameters
    ----------
    compared : ComparedScan
        The comparison, and which of its scans is at hand.
    inspection : Inspection
        Of that scan.
    points : (m, 3)
        Its points, local.
    rows : (m,)
        Where they stand in it.

    Returns
    -------
    deviations : (m,)
        That of the cell in which a point lies, upwards positive; NaN where not both scans saw the tread.
    """
    labels = labels_at(inspection, rows)
    deviations = np.full(len(rows), np.nan)
    motion = compared.found.alignment
    for step in compared.found.steps:
        if step.deviations is None:
            continue
        of_it = np.nonzero(labels == compared.number_of(step))[0]
        places = inspection.places(points[of_it], rows[of_it])
        if not compared.is_earlier:
            # The maps lie in the earlier scan.
            places = places @ motion.turn.T + motion.shift_m
        deviations[of_it] = _cells_at(step.deviations, places)
    return deviations


def _cells_at(found: TreadDeviations, places: Floats) -> Floats:
    offset = places - found.corner
    i, j = (np.floor(offset @ axis / found.cell_m**2).astype(np.int64) for axis in (found.ahead, found.aside))
    n_rows, n_columns = found.deviation_m.shape
    is_in = (i >= 0) & (i < n_rows) & (j >= 0) & (j < n_columns)
    deviations: Floats = np.where(
        is_in, found.deviation_m[np.clip(i, 0, n_rows - 1), np.clip(j, 0, n_columns - 1)], np.nan
    )
    return deviations
