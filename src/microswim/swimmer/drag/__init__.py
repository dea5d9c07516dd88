"""Local laws of drag on body and tail, and the coefficients of their interaction."""
