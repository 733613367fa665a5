"""A small reader of ISO 10303-11 EXPRESS."""
