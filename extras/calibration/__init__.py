"""Calibration: machines, materials and tool life fitted to measured runs."""
