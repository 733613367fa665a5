"""Feed optimisation: the best feed within the limits of the cutting process and the machine."""
