"""Write a run's outcomes, and the accepted corrections for its tools, into the program as
STEP-NC entities."""
