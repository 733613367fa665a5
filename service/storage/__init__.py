"""Data folder of the service: programs, jobs, keys, machines, materials."""
