"""Comparison of surfaces: what a log has left, what is required."""
