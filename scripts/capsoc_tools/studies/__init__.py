"""Measurements on many sensors that the pages quote."""
