"""Elastic tails: the shape that bending, drag and drive settle to, and the gait it makes."""
