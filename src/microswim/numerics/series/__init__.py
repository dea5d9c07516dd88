"""Fourier series in the phase, and their extreme values."""
