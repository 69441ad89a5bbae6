"""Loads on the sections of rods and on bodies: one file each kind, and the registry."""
