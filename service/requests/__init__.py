"""Requests of the verbs: what the command line fills, REST validates and jobs keep."""
