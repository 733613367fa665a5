"""Tool paths of programs, and NC code generated from them."""
