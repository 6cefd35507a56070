"""PTX files for tests."""

import numpy as np


def ptx_bytes(*stations, columns=1, rest=None):
    """The bytes of a PTX; each station is its points in its own frame, a turn (3, 3) and a place (3,)."""
    parts = []
    for points, turn, place in stations:
        matrix = np.eye(4)
        matrix[:3, :3], matrix[3, :3] = np.asarray(turn).T, place
        head = [np.asarray(place), *np.asarray(turn).T]
        parts += [str(columns), str(len(points) // columns)]
        parts += [" ".join(f"{value:.12g}" for value in row) for row in (*head, *matrix)]
        more = " 0.5" if rest is None else rest
        parts += [" ".join(f"{value:.8f}" for value in row) + more for row in points.tolist()]
    return ("\n".join(parts) + "\n").encode()
