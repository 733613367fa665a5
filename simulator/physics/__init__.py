"""Pure functions of the cut: engagement, force, power, surface, tool life, motion."""
