"""Kernels: inner loops in Python that run as machine code."""
