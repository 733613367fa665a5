"""Machine of the closed loop: what the controller sees, and what it may not know."""
