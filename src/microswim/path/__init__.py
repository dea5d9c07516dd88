"""Where a swimmer goes: stepping a gait in time, trajectories, the screw of one period."""
