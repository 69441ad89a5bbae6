"""What acts on rods: one file an effect, and the registry."""
