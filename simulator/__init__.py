"""What is: what the cut and the machine do."""
