"""REST: the door through which other programs and the dashboard come."""
