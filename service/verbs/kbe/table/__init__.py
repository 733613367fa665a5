"""Evaluate outcomes: planned, measured, deviations, grades, recommended actions."""
