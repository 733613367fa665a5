"""The trial cut: the paper's monitoring and optimisation simulator, on the real loop."""
