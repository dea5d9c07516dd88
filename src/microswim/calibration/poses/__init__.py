"""A gait as a function of the pose beside a wall: solved at chosen poses, interpolated between."""
