"""Formats in which a result is printed or written."""

from enum import StrEnum
from pathlib import Path

from stepnc_model.errors import StepNcError


class OutputFormat(StrEnum):
    """Format of a result."""

    TEXT = "text"
    CSV = "csv"
    JSON = "json"
    HTML = "html"
    PARQUET = "parquet"


SUFFIXES = {
    ".csv": OutputFormat.CSV,
    ".json": OutputFormat.JSON,
    ".html": OutputFormat.HTML,
    ".parquet": OutputFormat.PARQUET,
    ".txt": OutputFormat.TEXT,
}


def format_of(path: Path) -> OutputFormat:
    """Return the format that the name of a file ends with.

    Raises
    ------
    StepNcError
        When it ends otherwise.
    """
    form = SUFFIXES.get(path.suffix.lower())
    if form is None:
        known = ", ".join(SUFFIXES)
        raise StepNcError(f"{path}: end the name with {known}, or name the format")
    return form
