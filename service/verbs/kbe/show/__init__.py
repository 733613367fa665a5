"""Show one run in full, by its id or the start of it; or a correction, by its number."""
