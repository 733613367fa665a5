"""A machine fitted to measured runs."""
