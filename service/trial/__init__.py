"""Trial cut: the paper's monitoring and optimisation simulator, on the real control loop."""
