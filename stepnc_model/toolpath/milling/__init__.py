"""Milling: areas and flanks of features, exact offsets, and the passes of each level."""
