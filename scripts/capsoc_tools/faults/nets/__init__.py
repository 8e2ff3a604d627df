"""Nets of the synthesised coprocessor that are stuck."""
