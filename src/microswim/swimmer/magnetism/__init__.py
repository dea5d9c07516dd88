"""Magnets and the fields that drive them."""
