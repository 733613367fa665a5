"""Servers of HTTP: hosts, bounds, and problem details."""
