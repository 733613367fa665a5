"""Milling tool paths: areas and flanks of features, exact offsets, and passes by level."""
