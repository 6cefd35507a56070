"""The one list of findings: what the program found, and the pins of the inspector."""
