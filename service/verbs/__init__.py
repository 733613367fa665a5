"""Verbs: what the command line, REST, the dashboard and Python can ask for, a folder each."""
