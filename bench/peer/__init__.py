"""The peers of stiffarm in the benchmark: one index, one cell, several ways to minimise it."""
