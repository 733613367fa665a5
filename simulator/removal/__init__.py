"""Material removal: stock as height maps, and engagement of the tool along its path."""
