"""Fastest feed along a path, of numbers that know no machining."""
