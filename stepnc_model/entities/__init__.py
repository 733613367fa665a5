"""ISO 14649 entities as frozen dataclasses, attribute order = EXPRESS order."""
