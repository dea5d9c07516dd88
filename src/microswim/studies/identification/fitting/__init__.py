"""The fit: first guesses, descent, branches that fit alike, honest intervals."""
