"""Many solves, wherever they run: pools of processes, stores of solves, clusters."""
