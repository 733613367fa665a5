"""Kernels: inner loops written in Python that run as machine code."""
