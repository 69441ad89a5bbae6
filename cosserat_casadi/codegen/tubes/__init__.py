"""Concentric tubes in C: their equations with derivatives, their sources, and back in Python."""
