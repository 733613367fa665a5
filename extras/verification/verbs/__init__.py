"""Verb of verification."""
