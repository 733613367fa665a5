"""Withdraw accepted corrections, or reject proposals."""
