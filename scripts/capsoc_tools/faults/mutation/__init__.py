"""Mutants of the RTL against the regression."""
