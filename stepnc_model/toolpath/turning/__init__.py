"""Turning: half-plane profiles, the stock that is left, and the passes of each operation."""
