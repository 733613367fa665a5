"""ISO 14649 entities as frozen dataclasses, with attributes in EXPRESS order."""
