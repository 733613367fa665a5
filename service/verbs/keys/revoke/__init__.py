"""Revoke a key."""
