"""Figures of solutions, paths and sweeps."""
