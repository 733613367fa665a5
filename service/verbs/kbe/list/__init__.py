"""List outcomes, newest first."""
