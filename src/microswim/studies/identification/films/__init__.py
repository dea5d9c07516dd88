"""What is filmed: tracks, and how files of other programs are read."""
