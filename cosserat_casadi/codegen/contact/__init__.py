"""Rods in exact contact in C: which arrangements of contacts, their equations, their sources, and back in Python."""
