"""Simulation of the cut and of the machine."""
