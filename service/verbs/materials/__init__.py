"""List the materials, or show one."""
