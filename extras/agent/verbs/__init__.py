"""Verbs of agents: publish a run, and record what a machine tells."""
