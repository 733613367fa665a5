"""Virtual factory: machining cycles of programs, for the simulation of a shop."""
