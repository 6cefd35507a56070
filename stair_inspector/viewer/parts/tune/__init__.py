"""The settings: sliders, presets, the height histogram, runs to compare, sweeps."""
