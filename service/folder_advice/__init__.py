"""Advice for all programs of a folder."""
