"""The parts of the page, a folder each: scan, tune, steps, checks, look, export."""
