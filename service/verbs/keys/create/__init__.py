"""Create a key; it is shown only once."""
