"""One file per question asked of a scan; pure functions."""
