"""Motion of rods: inputs over time, trajectories, small motions about equilibria."""
