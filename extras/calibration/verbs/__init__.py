"""Verbs of calibration and of the tests that it reads."""
