"""Migrations of the tables of the knowledge base."""
