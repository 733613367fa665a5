"""Knowledge base: outcomes of runs, evaluation tables, corrections."""
