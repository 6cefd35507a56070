"""Everything that touches viser."""
