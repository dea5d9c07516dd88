"""Tails: what each states of itself, and every kind of them."""
