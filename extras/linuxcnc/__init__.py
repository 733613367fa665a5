"""LinuxCNC as a bench: a real control that runs programs, to compare with."""
