"""Facts given about a program beyond its file: units, raw part, missing data.

Raw part in a request: numbers, or a file that only the command line or a job can name.

A text is never taken for a path where a raw part is read. The command line makes a
:class:`StockFile` of what its user typed, and a job one of an upload; a request in JSON cannot
hold any.
"""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

from annotated_types import MaxLen

from service.files import PROGRAMS
from service.requests.fields import LONGEST_NAME, About, Request
from stepnc_model.errors import StepNcError
from stepnc_model.units import AUTO, PROFILES

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
    from service.inputs.part_file import part_place  # noqa: PLC0415 (numpy)

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
    from service.inputs.numbers import stock_in  # noqa: PLC0415 (the command line reads them later)

    if text:
        stock_in(text)
    return text


StockText = Annotated[RawPart, NumbersOnly()]
"""Raw part as a field of a request."""


Name = Annotated[str, MaxLen(LONGEST_NAME)]

Units = StrEnum("Units", {name.replace("-", "_"): name for name in (*PROFILES, AUTO)})  # type: ignore[misc]
"""Unit profiles of files, by name, and ``auto``."""

ISO = Units("iso")
"""Unit profile that follows the standard."""

FileUnits = Annotated[
    Units,
    About(
        "units of feeds and speeds in the file: iso (m/s, rev/s), rpm-mmin, rpm-mmtooth, "
        "rpm-mmrev, revs-mmtooth, revs-mmrev, rpm-mmtooth-mmrev, revs-mmtooth-mmrev (per tooth "
        "in milling, per turn in drilling), or auto: the only ones in which all numbers are "
        "plausible",
        group="the program",
        flag="--units",
    ),
]

GIVEN = ("units", "stock", "given", "teeth", "feed")
"""Names of the fields of :class:`ProgramRequest`, which other requests have too."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramRequest(Request):
    """Facts given about a STEP-NC program beyond its file; none of them is written there.

    Every command that reads a program takes it. Only ``optimise --in-place`` keeps the given
    data in the file.
    """

    units: FileUnits = ISO
    stock: Annotated[
        StockText,
        About(
            "raw part of NC code, or where the program defines none, in mm: x0,y0,z0,x1,y1,z1 "
            "of a box, diameter,z0,z1 or diameter,length of a bar, x,y,diameter,z0,z1 of an "
            "upright bar; on the command line also an STL or STEP file (part.step#SOLID), of "
            "NC code an .npz file of --keep-stock too",
            group="the program",
            flag="--stock", metavar="STOCK", examples=("0,0,-30,100,120,5",), read=raw_part_in,
        ),
    ] = ""  # fmt: skip
    given: Annotated[
        tuple[Name, ...],
        MaxLen(10_000),
        About(
            "value in place of the one in the file, or of one that it lacks, in its units: "
            "#INSTANCE.attribute=value; kept out of the file unless optimise is --in-place; "
            "repeatable",
            group="the program", flag="--set", metavar="VALUE", examples=("#46.depth=12",),
        ),
    ] = ()  # fmt: skip
    teeth: Annotated[
        tuple[Name, ...],
        MaxLen(1000),
        About(
            "number of teeth that the file lacks: TOOL=NUMBER; repeatable",
            group="the program", flag="--teeth", metavar="TOOL=N", examples=("T3=2",),
        ),
    ] = ()  # fmt: skip
    feed: Annotated[
        Name,
        About(
            "feed of technologies that give none: 240 in mm/min, or with its unit: 0.004m/s, "
            "0.1mm/tooth, 0.2mm/rev",
            group="the program", flag="--feed", metavar="FEED", examples=("240", "0.1mm/tooth"),
        ),
    ] = ""  # fmt: skip
