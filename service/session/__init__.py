"""Runs that people watch and steer while they go on: a program under control, a trial cut."""
