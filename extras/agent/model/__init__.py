"""Agent, its documents and device models, by the standard."""
