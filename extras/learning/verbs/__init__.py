"""Verbs of learning and of data sets."""
