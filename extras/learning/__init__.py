"""Models that learn from runs, and the data sets to learn from."""
