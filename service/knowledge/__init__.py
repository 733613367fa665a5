"""What the user does with the knowledge base."""
