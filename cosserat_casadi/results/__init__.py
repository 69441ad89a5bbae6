"""What was found, as JSON and CSV."""
