"""Elastic tails in time: their shape from any start, under loads that turn and pull in the lab."""
