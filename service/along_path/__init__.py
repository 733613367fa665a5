"""Feeds along the paths of a program: what its tools meet, the plan, and its judge."""
