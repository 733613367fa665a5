"""Verification: the part that a log of positions left, compared with the programmed one."""
