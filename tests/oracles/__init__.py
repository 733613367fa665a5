"""Formulas of books and papers that the product does not call: tests hold it against them."""
