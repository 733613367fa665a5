"""Files of a live run: rows, events, status, and requested changes."""
