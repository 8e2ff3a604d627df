"""Planted faults: one form of list, one planter, a runner for each list."""
