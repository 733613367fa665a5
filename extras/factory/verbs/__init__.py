"""Verb of the factory."""
