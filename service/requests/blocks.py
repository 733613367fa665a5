"""Requests of the commands on block rate and cycle time."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated

from annotated_types import Interval

from service.requests.fields import About, Request
from stepnc_model.units import inches_from_mm, mm_from_inches


class LengthUnit(StrEnum):
    """Unit of lengths that a user enters."""

    INCH = "in"
    MILLIMETRE = "mm"

    def to_mm(self, length: float) -> float:
        """Length in mm."""
        return mm_from_inches(length) if self is LengthUnit.INCH else length

    def from_mm(self, length: float) -> float:
        """Length in this unit from mm."""
        return inches_from_mm(length) if self is LengthUnit.INCH else length


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockTestRequest(Request):
    """Request of a test program for the block rate; lists are in the unit of ``unit``."""

    machine: Annotated[
        str, About("one of `stepnc machines`, or your own file", flag="--machine")
    ] = ""  # fmt: skip
    dialect: Annotated[
        str,
        About("dialect of the NC code (default: by the file extension)", flag="--dialect",
              metavar="NAME"),
    ] = ""  # fmt: skip
    unit: Annotated[
        LengthUnit, About("unit of the lists and the feed: in or mm", flag="--unit")
    ] = LengthUnit.INCH
    spacing: Annotated[
        tuple[float, ...] | None,
        About(
            "distances between points (default: those of paper 004, 0.0001 to 0.01 in)",
            flag="--spacing", metavar="S,S,…",
        ),
    ] = None  # fmt: skip
    radius: Annotated[
        tuple[float, ...] | None,
        About("radii of the circles (default: 0.5, 1 and 2 in)", flag="--radius",
              metavar="R,R,…"),
    ] = None  # fmt: skip
    feed: Annotated[
        float | None,
        Interval(gt=0.0, le=300_000.0),
        About("commanded feed in units a minute (default: the machine's greatest)",
              flag="--feed", metavar="F"),
    ] = None  # fmt: skip
    lines: Annotated[
        int,
        Interval(ge=50, le=100_000),
        About("lines of each circle", flag="--lines", metavar="N"),
    ] = 1000
