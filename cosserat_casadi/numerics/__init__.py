"""Numerical methods independent of rods: Newton, Broyden, continuation, arclength, descent, motion."""
