"""What was: outcomes, evaluation tables, corrections."""
