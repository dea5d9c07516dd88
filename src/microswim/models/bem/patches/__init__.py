"""Surfaces as patches: closed shapes, swimmers, tubes, files."""
