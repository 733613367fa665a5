"""Output files: rows of a run, tables and folders that appear whole."""
