"""Predict with a learned model.

Name the settings of one part, or a table of rows. Settings outside the trained box are refused.
"""
