"""Tails drawn from samples of a beat: read, fitted, evaluated."""
