"""Virtual factory: a shop of machines that run programs."""
