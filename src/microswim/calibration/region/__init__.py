"""Corrections of the surrogate that vary smoothly over a region of designs."""
