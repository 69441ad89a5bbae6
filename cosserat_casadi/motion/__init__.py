"""Motion: inputs over time, simulation, what a motion is, modes and linearisation."""
