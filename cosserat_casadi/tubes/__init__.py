"""Concentric tubes: nested pre-curved tubes that turn and slide in each other, and bear loads. See docs/tubes.md."""
