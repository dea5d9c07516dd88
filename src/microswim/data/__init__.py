"""Published data with their birthplace."""
