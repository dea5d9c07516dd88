"""The model for another program: C for firmware, FMU for simulators."""
