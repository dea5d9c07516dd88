"""Calibration of the surrogate by a reference, at one design or over a region; validation."""
