"""Runs that people steer: they go on in wall time, tell how they are, and obey."""
