"""Tolerances of lengths, as written in the file or defined by standards for a size.

Only the half-width is used: half the difference between the greatest and the least permitted
size. The position of the tolerance zone is not used. Lengths are in mm.

References
----------
.. [1] ISO 286-1:2010, Geometrical product specifications, ISO code system for tolerances on
   linear sizes, Table 1.
.. [2] ISO 2768-1:1989, General tolerances, Table 1, class m.
"""

import re
import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.measures import (
    LimitsAndFits,
    PlusMinusValue,
    TolerancedLengthMeasure,
)
from stepnc_model.errors import Finding, Severity
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.units import mm_from_um

TABLES = Path(__file__).with_name("tolerances.toml")

GREATEST_GRADE = 18
"""Greatest grade, IT18; IT01 and IT0 are omitted, as milling does not reach them."""

GREATEST_FINE_GRADE = 13
"""Greatest grade for sizes up to 1 mm, [1]_ Table 1, note."""

LEAST_COARSE_SIZE = 1.0
"""Size, mm, up to which grades above ``GREATEST_FINE_GRADE`` do not exist."""

LETTERS = frozenset(
    "A B C CD D E EF F FG G H J JS K M N P R S T U V X Y Z ZA ZB ZC".split()  # noqa: SIM905
)
"""Fundamental deviations of holes, [1]_; shafts use the same in small letters."""

_GRADE = re.compile(r"(?:IT|([A-Z]{1,2}))? ?([0-9]{1,2})", re.IGNORECASE)


@dataclass(frozen=True, slots=True, kw_only=True)
class Tolerance:
    """Tolerance of a length."""

    half_width: float
    """Half the difference between the limits of size, mm."""
    code: str
    """Tolerance as on a drawing: ±0.1 mm, +0.2/-0.1 mm, IT7, ISO 2768-m."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FileTolerance:
    """Tolerance of a length as given in the file."""

    tolerance: Tolerance | None
    """Tolerance, or None if the file gives none or it cannot be read."""
    finding: Finding | None = None
    """Reason why the tolerance cannot be read."""


def written_tolerance(program: Program, ref: Ref[TolerancedLengthMeasure]) -> FileTolerance:
    """Read the tolerance of a length from the file.

    A tolerance that cannot be read is not an error but a warning that names its instance.
    """
    length = program.model.entity(int(ref))
    if not isinstance(length, TolerancedLengthMeasure) or length.implicit_tolerance is None:
        return FileTolerance(tolerance=None)
    given = program.model.entity(int(length.implicit_tolerance))
    try:
        return FileTolerance(tolerance=_read(given, length.theoretical_size))
    except ValueError as error:
        place: Ref[Entity] = Ref(int(length.implicit_tolerance))
        if int(place) not in program.file:
            place = Ref(int(ref))
        text = f"{error}: the tolerance is ignored, ISO 2768-m is used instead"
        finding = program.finding(Severity.WARNING, text, place)
        return FileTolerance(tolerance=None, finding=finding)


def tolerance_findings(program: Program) -> tuple[Finding, ...]:
    """Warnings for all tolerances of the file that cannot be read."""
    lengths = program.model.of_type(TolerancedLengthMeasure)
    found = (written_tolerance(program, ref).finding for ref, _ in lengths)
    return tuple(dict.fromkeys(finding for finding in found if finding is not None))


def standard_tolerance(size: float, grade: int) -> float:
    """Difference between the limits of size of a standard tolerance grade, [1]_.

    Parameters
    ----------
    size : float, mm
        Nominal size, at most 3150 mm.
    grade : int
        1 to 18 for IT1 to IT18.

    Returns
    -------
    float, mm

    Raises
    ------
    ValueError
        If the table has no value for the grade and size.

    Examples
    --------
    The tolerance of 25H7 is 21 µm:

    >>> standard_tolerance(25.0, 7)
    0.021
    """
    if not 1 <= grade <= GREATEST_GRADE:
        raise ValueError(f"IT{grade}: ISO 286-1 has grades IT1 to IT{GREATEST_GRADE}")
    if size <= LEAST_COARSE_SIZE and grade > GREATEST_FINE_GRADE:
        raise ValueError(f"IT{grade}: ISO 286-1 has no such grade for sizes up to 1 mm")
    for row in _tables()["standard"]["rows"]:
        if 0.0 < size <= row["up_to_mm"]:
            return mm_from_um(row["width_um"][grade - 1])
    raise ValueError(f"size {size:g} mm: ISO 286-1 gives tolerances up to 3150 mm")


def general_tolerance(size: float) -> Tolerance:
    """General tolerance of a length by its nominal size: ISO 2768-m, [2]_.

    Below 0.5 mm and above 4000 mm the standard requires an individual tolerance; here the
    nearest row of the table is used.

    Parameters
    ----------
    size : float, mm

    Returns
    -------
    Tolerance

    Examples
    --------
    >>> general_tolerance(12.0).half_width
    0.2
    """
    rows = _tables()["general"]["rows"]
    row = next((row for row in rows if size <= row["up_to_mm"]), rows[-1])
    return Tolerance(half_width=float(row["deviation_mm"]), code="ISO 2768-m")


@cache
def _tables() -> dict[str, Any]:
    """Tables of the standards."""
    return tomllib.loads(TABLES.read_text(encoding="utf-8"))


def _read(entity: Entity | None, size: float) -> Tolerance:
    """Tolerance of a length by its nominal size; ValueError if it cannot be read."""
    if isinstance(entity, PlusMinusValue):
        return _plus_minus(entity)
    if isinstance(entity, LimitsAndFits):
        return _fit(entity, size)
    raise ValueError("this kind of tolerance is not supported")


def _plus_minus(limits: PlusMinusValue) -> Tolerance:
    """Tolerance given by upper and lower limits."""
    upper, lower = limits.upper_limit, limits.lower_limit
    if not _are_numbers(upper, lower):
        raise ValueError("the upper or lower limit is missing")
    if upper < 0.0 or lower < 0.0:
        raise ValueError(
            f"limits +{upper:g}/-{lower:g} mm: both must be written as positive numbers"
        )
    if upper + lower == 0.0:
        raise ValueError("limits of 0 mm cannot be machined")
    code = f"±{upper:g} mm" if upper == lower else f"+{upper:g}/-{lower:g} mm"
    return Tolerance(half_width=0.5 * (upper + lower), code=code)


def _fit(limits: LimitsAndFits, size: float) -> Tolerance:
    """Tolerance given by its grade; the deviation only shifts the zone."""
    grade, letters = _grade(limits.grade)
    for written in (limits.deviation, letters):
        if isinstance(written, str) and written and written.upper() not in LETTERS:
            raise ValueError(f"'{written}' is not a fundamental deviation of ISO 286-1")
    if not _are_numbers(size):
        raise ValueError("a tolerance grade needs a nominal size")
    width = standard_tolerance(size, grade)
    return Tolerance(half_width=0.5 * width, code=f"IT{grade}")


def _are_numbers(*values: object) -> bool:
    """True if all values are numbers; a missing value is None."""
    return all(isinstance(value, float) for value in values)


def _grade(written: float | str) -> tuple[int, str]:
    """Number of a grade, and the deviation if written with it, as in 7, 'IT7' or 'H7'."""
    if isinstance(written, float) and written.is_integer():
        return int(written), ""
    found = _GRADE.fullmatch(written.strip()) if isinstance(written, str) else None
    if found is None:
        shown = f"{written:g}" if isinstance(written, float) else f"'{written or ''}'"
        raise ValueError(
            f"grade {shown}: an ISO 286-1 grade must be a whole number, such as 7 for IT7"
        )
    return int(found[2]), found[1] or ""
