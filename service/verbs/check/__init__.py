"""Show the contents of a program or of NC code and its errors; exit 3 if it is unusable."""
