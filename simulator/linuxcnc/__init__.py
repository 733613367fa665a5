"""LinuxCNC without a screen: an extra that runs NC code on the real interpreter and planner."""
