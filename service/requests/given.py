"""What a command is told about a program beyond its file: units, raw part, missing data."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated

from annotated_types import MaxLen

from service.requests.fields import LONGEST_NAME, About, Request
from service.requests.stock import StockText, raw_part_in
from stepnc_model.units import AUTO, PROFILES

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
    """What is given about a STEP-NC program beyond its file; none of it is written there.

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
