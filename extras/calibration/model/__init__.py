"""Fits, and the features of measured runs that they use."""
