"""How the tables of the knowledge base came about."""
