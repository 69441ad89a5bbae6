"""Concentric tubes: nested pre-curved tubes that turn and slide in each other, without loads. See docs/tubes.md."""
