"""Feed along the path: caps by station, and the fastest feeds within them."""
