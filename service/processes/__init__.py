"""Processes that this one starts, and the log of all."""
