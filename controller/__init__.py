"""What to do now: the feed override from the measured force."""
