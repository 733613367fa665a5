"""Counts in words: a number with its noun in the singular or the plural."""


def counted(number: int, noun: str, plural: str = "") -> str:
    """Return a number with its noun, as a message states it.

    Parameters
    ----------
    number : int
    noun : str
        Singular.
    plural : str, optional
        Plural of nouns that do not take an s.

    Examples
    --------
    >>> counted(1, "line"), counted(2, "line"), counted(0, "pass", "passes")
    ('1 line', '2 lines', '0 passes')
    """
    return f"{number} {noun if number == 1 else plural or noun + 's'}"
