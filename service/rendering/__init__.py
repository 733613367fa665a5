"""Rendering of results as text, HTML, CSV and JSON, each from one list of columns."""
