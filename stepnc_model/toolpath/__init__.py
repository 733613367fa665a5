"""Tool paths: lines and arcs by station, made from features or taken from the file."""
