"""Tables of the spec, one module for each part of a swimmer."""
