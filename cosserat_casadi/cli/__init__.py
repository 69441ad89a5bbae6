"""The command line: one file a command, what they print, and what they show while they run."""
