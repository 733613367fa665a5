"""Fill an empty knowledge base from a backup."""
