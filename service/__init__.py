"""Command line, REST service and dashboard."""
