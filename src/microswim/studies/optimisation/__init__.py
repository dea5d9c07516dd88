"""Designs that serve a purpose best, how sensitive and how robust they are."""
