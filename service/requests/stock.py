"""Raw part in a request: numbers, or a file that only the command line or a job can name.

A text is never taken for a path where a raw part is read. The command line makes a
:class:`StockFile` of what its user typed, and a job one of an upload; a request in JSON cannot
hold any.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from service.file_names import PROGRAMS
from stepnc_model.errors import StepNcError

KEPT_SUFFIX = ".npz"
"""Ending of a file that keeps a stock."""

MESH_SUFFIX = ".stl"

PART_SUFFIXES = frozenset({MESH_SUFFIX, ".step"}) | PROGRAMS
"""Usual endings of files that have a part; their content tells how they are read."""

LONGEST_NUMBERS = 200
"""Largest number of characters of a raw part in numbers."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StockFile:
    """File with a raw part."""

    path: Path
    solid: str = ""
    """Solid of a STEP file, by its name or its place in the file; empty: its only one."""


RawPart = str | StockFile
"""Numbers, never a path; or a file."""


def raw_part_in(text: str) -> RawPart:
    """Read a raw part that the user of the command line typed.

    A file is told by its ending; one with another ending, by being there.

    Raises
    ------
    StepNcError
        When the text can be neither numbers nor a file.
    """
    from service.part_file import part_place  # noqa: PLC0415 (numpy)

    path, solid = part_place(text.strip())
    is_named = path.suffix.lower() in PART_SUFFIXES | {KEPT_SUFFIX}
    if is_named or ("," not in text and path.is_file()):
        return StockFile(path=path, solid=solid)
    if text and "," not in text:
        raise StepNcError(
            f"stock '{text}': expected numbers separated by commas, an STL file "
            f"({MESH_SUFFIX}), a STEP file (.step) or a kept stock ({KEPT_SUFFIX})"
        )
    return text


@dataclass(frozen=True, slots=True)
class NumbersOnly:
    """Schema of a raw part in JSON: numbers that are those of a stock, or an empty text."""

    def __get_pydantic_core_schema__(self, _source: Any, _handler: Any) -> Any:
        """Return the schema of values; called by pydantic."""
        from pydantic_core import core_schema  # noqa: PLC0415 (slow to import)

        text = core_schema.str_schema(max_length=LONGEST_NUMBERS)
        return core_schema.no_info_after_validator_function(_checked, text)


def _checked(text: str) -> str:
    """Return numbers of a stock as they are."""
    from service.numbers import stock_in  # noqa: PLC0415 (the command line reads them later)

    if text:
        stock_in(text)
    return text


StockText = Annotated[RawPart, NumbersOnly()]
"""Raw part as a field of a request."""
