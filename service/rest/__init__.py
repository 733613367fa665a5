"""REST service, used by the dashboard and by other programs."""
