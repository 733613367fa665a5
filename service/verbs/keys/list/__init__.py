"""List the keys, without their secrets."""
