"""Many designs, by any model, kept on disk."""
