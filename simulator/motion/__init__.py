"""Motion of the axes: segments of a path, control models, and position over time."""
