"""Calibration of machine files and tool life to measurements."""
