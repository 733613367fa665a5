"""List corrections and their status."""
