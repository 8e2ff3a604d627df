"""Comparisons: builds, checkpoints, other simulators."""
