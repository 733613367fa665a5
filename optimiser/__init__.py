"""Optimiser: the best feed within the limits of physics and machine."""
