"""Tool paths, and NC code made of them."""
