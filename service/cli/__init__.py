"""Command line of the project: ``stepnc`` and ``optimise``."""
