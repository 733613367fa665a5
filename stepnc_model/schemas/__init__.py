"""EXPRESS schemas of the entities that ISO 14649 lacks."""
