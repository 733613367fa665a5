"""Add outcomes of real runs from a JSON file, as `export outcomes` writes it."""
