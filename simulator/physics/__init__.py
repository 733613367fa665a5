"""Pure functions of cutting physics: engagement, force, power, surface, tool life, motion."""
