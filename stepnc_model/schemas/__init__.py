"""EXPRESS schemas of entities that ISO 14649 does not define."""
