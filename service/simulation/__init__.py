"""Simulation of a program on the virtual machine."""
