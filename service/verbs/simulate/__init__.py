"""Run a program on a virtual machine: time, force, power and energy."""
