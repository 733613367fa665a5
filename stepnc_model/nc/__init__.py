"""NC code of any origin: read without loss, executed, and rewritten in its feeds alone."""
