"""The spec file: its fields, their units, reading and writing, and the presets that come along."""
