"""Bodies without closed form: capsule, cylinder, revolution, box, surface from a file."""
