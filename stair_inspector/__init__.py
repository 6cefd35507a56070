"""Measure staircases in 3-D scans: the paper's method, exact, and a survey of real stairs beside it."""

__version__ = "0.1.0"
