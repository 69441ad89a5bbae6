"""The command line: one file per command, with reports and progress bars."""
