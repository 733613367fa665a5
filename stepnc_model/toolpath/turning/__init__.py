"""Turning tool paths: half-plane profiles, the remaining stock, and passes by operation."""
