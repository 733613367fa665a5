"""List the machines, or show one."""
