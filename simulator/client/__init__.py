"""MTConnect client: observations of a machine, real or virtual, as columns."""
