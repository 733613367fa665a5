"""Predict measured cuts and show predicted beside measured values; no model is written.

Rows marked fit in the column use, and those that the material's file keeps, are fitted; the
others are predicted. Without fitted rows, each condition is predicted from the others.
"""
