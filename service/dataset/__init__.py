"""Data sets: many parts run on the virtual machine, by a design of experiments."""
