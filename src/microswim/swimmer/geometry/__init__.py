"""Shapes: bodies, tails, and what surrounds the swimmer."""
