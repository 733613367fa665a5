"""Control laws behind one interface."""
