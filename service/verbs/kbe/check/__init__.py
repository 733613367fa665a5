"""Check the integrity of all stored data."""
