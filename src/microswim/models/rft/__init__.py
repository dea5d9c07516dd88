"""Resistive force theory, the surrogate: a gait in microseconds [Tabak Eqs. 4-6, 13-15]."""
