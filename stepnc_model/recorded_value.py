"""Numbers and times of a record in a file: checked on their way in, and taken as found out."""

from datetime import datetime
from math import inf, isfinite

from stepnc_model.writeback import rounded


def written(time: datetime) -> str:
    """A time as ISO 8601 with its zone."""
    if time.utcoffset() is None:
        raise ValueError(f"{time.isoformat()} has no time zone")
    return time.isoformat()


def measured_or_none(value: float | None, name: str, unit: str) -> float | None:
    """A number that may be 0; None when it was not measured."""
    return 0.0 if value == 0.0 else positive_or_none(value, name, unit)


def positive_or_none(value: float | None, name: str, unit: str) -> float | None:
    """A number above 0; None when it was not measured."""
    return None if value is None else positive(value, name, unit)


def positive(value: float, name: str, unit: str) -> float:
    """A number above 0 as it is written."""
    number = rounded(value)
    if not 0.0 < number < inf:
        raise ValueError(f"a {name} of {value:g} {unit}".rstrip())
    return number


def known(value: object) -> float | None:
    """A number of the file that is one; the binding is tolerant."""
    return float(value) if isinstance(value, int | float) and isfinite(value) else None


def instant(text: object) -> datetime | None:
    """A time of the file, where it is one and has a zone."""
    if not isinstance(text, str):
        return None
    try:
        time = datetime.fromisoformat(text)
    except ValueError:
        return None
    return None if time.utcoffset() is None else time
