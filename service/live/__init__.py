"""A run while it runs: its rows, its events, and what is asked of it."""
