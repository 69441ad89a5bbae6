"""Equilibria of a model: solving, judging what was found, stability, relaxing to a stable one."""
