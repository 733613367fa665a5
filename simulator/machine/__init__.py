"""The virtual machine: here lives state."""
