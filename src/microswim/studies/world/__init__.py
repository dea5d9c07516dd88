"""Measured cells and robots beside the model, on one page."""
