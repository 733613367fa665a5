"""Texts that a spreadsheet would calculate; an apostrophe before them keeps them texts."""

FIRST = "=+-@\t\r"
"""one of these is what such a text begins with"""


def disarmed(text: str) -> str:
    """The text, with an apostrophe if it needs one."""
    return f"'{text}" if text.startswith(tuple(FIRST)) else text
