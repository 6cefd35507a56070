"""The scan: which file, its unit, up and region."""
