"""Staircases of known geometry, and a simulated scanner."""
