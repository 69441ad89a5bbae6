"""Equations and their numbers, knowing nothing of rods: Newton, Broyden, continuation, arclength, descent, motion."""
