"""The coprocessor's RTL: file list, linter, proofs, synthesis."""
