"""A robot in a turning field: its steady states, step-out and wobbling, from its gait alone."""
