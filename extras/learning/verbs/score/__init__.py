"""Score a learned model on measured runs, and watch them for drift.

Runs are a table in the order in which they were made, with settings and measured target. An
alarm ends with exit code 5.
"""
