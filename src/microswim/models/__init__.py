"""The judges: boundary elements in free space (`bem`) and finite elements in a channel (`fem`).

They solve the Stokes equations from first principles and depend on swimmer, bodies, tails, gait and
errors alone, never on the surrogate they judge.
"""
