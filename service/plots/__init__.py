"""Figures of runs and plans."""
