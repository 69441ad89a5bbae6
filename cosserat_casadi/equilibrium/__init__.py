"""Equilibria of a model: solving, judging the end of a solve, stability, relaxing to a stable equilibrium."""
