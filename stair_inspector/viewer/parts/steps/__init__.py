"""The steps: the table, the card of the chosen step, and the inspector's verdicts."""
