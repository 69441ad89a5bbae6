"""Solving: outcomes, globalised Newton, load continuation, stability, accuracy."""
