"""Control laws for the feed override, behind one interface."""
