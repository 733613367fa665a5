"""From sensor readings to the force of each revolution, and the expected force."""
