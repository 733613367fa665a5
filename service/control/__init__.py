"""Runs of a program under force control, on the virtual machine."""
