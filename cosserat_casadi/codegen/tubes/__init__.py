"""Concentric tubes in C: their equations with derivatives, their sources, and loading into Python."""
