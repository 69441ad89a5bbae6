"""Obstacles that rods may not enter, each a signed distance in one file."""
