"""Kernels as the Python they are written in, or compiled: when, on how many cores, kept where."""
