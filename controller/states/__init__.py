"""State machine of the control loop."""
