"""Results as text, HTML, CSV and JSON, from one list of columns each."""
