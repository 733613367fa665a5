"""Limits of a cut, by what they protect."""
