"""A gait as a function of the pose beside a boundary."""
