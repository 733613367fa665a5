"""What the service keeps in its data folder: programs, jobs, keys, machines, materials."""
