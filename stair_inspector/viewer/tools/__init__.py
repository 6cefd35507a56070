"""The tools with which an inspector looks and measures in the scene, one file each: its controls and what they do."""
