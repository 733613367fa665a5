"""Copy the knowledge base to a new file."""
