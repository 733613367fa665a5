"""Functions of the knowledge base commands: record, evaluate, review, export and correct."""
