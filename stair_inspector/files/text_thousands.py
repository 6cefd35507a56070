"""Marks that part thousands in a text, which read as decimals would make a thousandth of some coordinates."""

import re
from collections.abc import Iterable, Sequence

import numpy as np

from stair_inspector.geometry.arrays import Floats

_PARTED = re.compile(rb"[+-]?[1-9]\d{0,2}\.\d{3}")
"""A cell in which the mark may part thousands; decimal commas are points by now."""
_UNPARTED = re.compile(rb"[+-]?[1-9]\d{0,2}")
_ZERO = re.compile(rb"[+-]?0+")


def may_part_thousands(coordinates: Sequence[Floats]) -> bool:
    """Return whether coordinates may be whole numbers above 1000 that lost their marks, beside smaller ones.

    It is by what they are only, and quick: their text must be looked at where it holds.
    """
    has_whole = has_parted = False
    for values in coordinates:
        is_whole = values == np.rint(values)
        whole, parted = np.abs(values[is_whole]), np.abs(values[~is_whole & np.isfinite(values)])
        in_thousandths = 1000.0 * parted
        if (whole >= 1000.0).any() or (parted < 1.0).any() or (parted >= 1000.0).any():
            return False
        if (np.abs(in_thousandths - np.rint(in_thousandths)) > 1e-6).any():
            return False
        has_whole |= bool((whole > 0.0).any())
        has_parted |= bool(len(parted))
    return has_whole and has_parted


def thousands_in(rows: Iterable[Sequence[bytes]]) -> bytes | None:
    """Return a cell whose mark parts thousands, by the cells of the coordinates in each row; None where none does.

    They are parted where each mark has three digits behind it and others stand without one: "1.098", "950", "170".
    Metres to the millimetre have the mark everywhere.
    """
    shown: bytes | None = None
    has_unparted = False
    for row in rows:
        for cell in row:
            if b"." in cell:
                if _PARTED.fullmatch(cell) is None:
                    return None
                shown = shown or cell
            elif _UNPARTED.fullmatch(cell) is not None:
                has_unparted = True
            elif _ZERO.fullmatch(cell) is None:
                return None
    return shown if has_unparted else None
