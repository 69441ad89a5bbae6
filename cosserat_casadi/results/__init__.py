"""Results as JSON and CSV files: one module each for solutions, paths, motions, inverse problems and so on."""
