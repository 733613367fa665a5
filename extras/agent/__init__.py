"""MTConnect agent: a run, or a shop of machines, published to clients."""
