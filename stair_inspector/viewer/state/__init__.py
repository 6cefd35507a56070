"""The work on a scan, its history, and what is kept of it."""
