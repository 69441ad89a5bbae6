"""Texts in C on their way to machine code: sources read, functions listed, libraries compiled and kept."""
