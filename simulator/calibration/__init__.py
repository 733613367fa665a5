"""Machine and cutting parameters fitted to measured runs."""
