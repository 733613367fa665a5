"""Tool paths as lines and arcs by station, generated from features or read from the file."""
