"""Names of files in messages: stored files are named as their owners named them."""

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from stepnc_model.errors import StepNcError

PROGRAMS = frozenset({
    ".stpnc",
    ".stp",
    ".step",
    ".p21",
    ".238",
    ".stpncz",
    ".stpz",
    ".238z",
    ".p21z",
})
"""Suffixes of STEP-NC programs; other files are NC code."""

LOGS = frozenset({".parquet", ".csv", ".xml", ".shdr", ".log"})
"""Suffixes of recorded runs."""

Names = Mapping[Path, str]
"""Names that owners gave to files."""


def with_names(text: str, names: Names) -> str:
    """Return a text with the owners' names of files in place of their paths."""
    for path, name in names.items():
        text = text.replace(str(path), name).replace(path.name, name)
    return text


@contextmanager
def naming(names: Names) -> Iterator[None]:
    """Let errors within it name files as their owners named them.

    Raises
    ------
    StepNcError
        In place of one that names a path; others pass unchanged.
    """
    try:
        yield
    except StepNcError as error:
        text = with_names(str(error), names)
        if text == str(error):
            raise
        raise StepNcError(text) from error


def plain_name(text: str) -> str:
    """Return a text as it can name a file everywhere."""
    return re.sub(r"[^A-Za-z0-9._-]", "_", text)[:150]
