"""A program on the virtual machine."""
