"""Knowledge base: outcomes of runs, evaluation tables, and learned corrections of k_c."""
