"""Explicit tool paths of the file, used as they are given."""
