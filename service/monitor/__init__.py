"""Monitors of real machines: what their MTConnect agents tell, beside a prediction."""
