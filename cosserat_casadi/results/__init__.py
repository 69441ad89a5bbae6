"""What was found, as JSON and CSV: one file each for solutions, paths and inverse problems."""
