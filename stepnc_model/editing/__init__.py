"""Changes of a program, written into the bytes that were read."""
