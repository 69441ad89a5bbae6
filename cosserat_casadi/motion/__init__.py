"""Motion of a scene: over time, and small about an equilibrium."""
