"""The language of ``--columns``: what each column of a scan in text is, as ``-,x,y,z,r,g,b``."""

from collections import Counter

from stair_inspector.errors import ConfigError

SKIPPED = "-"
"""Stands for a column that is not read."""
ROLES = {
    "x": "x",
    "y": "y",
    "z": "z",
    "r": "red",
    "g": "green",
    "b": "blue",
    "red": "red",
    "green": "green",
    "blue": "blue",
    "i": "intensity",
    "intensity": "intensity",
    "nx": "nx",
    "ny": "ny",
    "nz": "nz",
    SKIPPED: "",
    "skip": "",
}
"""Each word of the language, and what the column is then called in a scan; nothing for one that is not read."""
_LONGEST = 2000


def parse_columns(text: str) -> tuple[str, ...]:
    """Return what each column is, by the values of ROLES; an empty tuple where the file is to say it.

    Raises
    ------
    ConfigError
        An unknown word, one that comes twice, or no x, y or z.

    Examples
    --------
    >>> parse_columns("-,x,y,z,i")
    ('', 'x', 'y', 'z', 'intensity')
    >>> parse_columns("auto")
    ()
    """
    words = [word.strip().lower() for word in text[:_LONGEST].split(",")]
    if words in (["auto"], [""]):
        return ()
    known = [ROLES.get(word) for word in words]
    counts = Counter(filter(None, known))
    if None in known or max(counts.values(), default=0) > 1 or not all(counts[axis] for axis in "xyz"):
        raise ConfigError(
            f"columns: got {text[:60]!r}; name x, y and z once each, in the order of the file, as -,x,y,z,r,g,b: '-' "
            "skips a column, and there are r, g, b, intensity, nx, ny and nz; or give auto"
        )
    return tuple(role for role in known if role is not None)
