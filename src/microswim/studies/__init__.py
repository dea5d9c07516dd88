"""What one does with many gaits: sweeps, optimisation, identification, the paper, the world."""
