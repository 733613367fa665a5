"""Protection of text cells that a spreadsheet would take for formulas."""

FIRST = "=+-@\t\r"
"""First characters that make a spreadsheet treat a text as a formula."""


def disarmed(text: str) -> str:
    """Return the text, with an apostrophe if a spreadsheet would take it for a formula."""
    return f"'{text}" if text.startswith(tuple(FIRST)) else text
