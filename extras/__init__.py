"""Extras: what only some users need. The core imports none of them, and finds them by name."""
