"""Reports of commands: tables and sentences."""
