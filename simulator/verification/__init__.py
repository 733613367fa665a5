"""Verification of logged positions: the part they left, compared with the programmed one."""
