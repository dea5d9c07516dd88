"""Tails that bend: the filament, its shape at rest, the hook."""
