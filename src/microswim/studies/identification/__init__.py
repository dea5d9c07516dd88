"""What a filmed track tells about the swimmer that made it."""
