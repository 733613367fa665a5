"""What should be: the best feed within the physics."""
