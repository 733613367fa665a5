"""Material removal: stock as height maps, and the engagement of the tool along a path."""
