"""Rods in exact contact in C: choice of arrangements of contacts, their equations and sources, and loading."""
