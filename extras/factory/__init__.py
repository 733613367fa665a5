"""Virtual factory: a shop of machines that run programs, with its jobs and routes."""
