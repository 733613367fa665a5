"""Greatest rise of feeds in NC code. Imports nothing slow: requests name it."""

USUAL_RISE = 3.0
"""Feed over the programmed one, at most, unless the user permits more."""
