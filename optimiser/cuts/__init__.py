"""Cuts of workingsteps: geometry, conditions, and engagement along the path."""
