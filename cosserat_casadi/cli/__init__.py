"""The command line: one file a command, their reports, and their progress."""
