"""The HEADER section of an exchange structure, as far as it follows the standard.

References
----------
.. [1] ISO 10303-21:2016, 8.2 (file_description, file_name, file_schema).
"""

from dataclasses import dataclass, replace

from stepnc_model.part21.places import Slip
from stepnc_model.part21.record import parse_record
from stepnc_model.part21.structure import Statement
from stepnc_model.part21.values import Value

_ARITY = {"FILE_DESCRIPTION": 2, "FILE_NAME": 7, "FILE_SCHEMA": 1}


@dataclass(frozen=True, slots=True, kw_only=True)
class Header:
    """Header of a file; what it does not say is empty."""

    description: tuple[str, ...] = ()
    implementation_level: str = ""
    name: str = ""
    time_stamp: str = ""
    author: tuple[str, ...] = ()
    organisation: tuple[str, ...] = ()
    preprocessor_version: str = ""
    originating_system: str = ""
    authorisation: str = ""
    schemas: tuple[str, ...] = ()
    """names as written, blank ones dropped"""


@dataclass(frozen=True, slots=True, kw_only=True)
class HeaderReading:
    """A header and what was wrong with it."""

    header: Header
    slips: tuple[Slip, ...]


def read_header(data: bytes, statements: tuple[Statement, ...]) -> HeaderReading:
    """Header made of the statements of a file; deviations are noted, never fatal."""
    slips: list[Slip] = []
    values: dict[str, tuple[Value, ...]] = {}
    for statement in statements:
        if statement.keyword not in _ARITY:
            continue
        if statement.keyword in values:
            message = f"{statement.keyword} is given twice; the first counts"
            slips.append(Slip(offset=statement.start, message=message))
            continue
        values[statement.keyword] = _parameters(data, statement, slips=slips)
    missing = (keyword for keyword in _ARITY if keyword not in values)
    slips.extend(Slip(offset=0, message=f"{keyword} is missing") for keyword in missing)
    return HeaderReading(header=_header(values), slips=tuple(slips))


def _parameters(data: bytes, statement: Statement, *, slips: list[Slip]) -> tuple[Value, ...]:
    """Values of one statement; none where they cannot be read."""
    record = parse_record(data[statement.start : statement.end].decode("latin-1"))
    slips.extend(replace(slip, offset=statement.start + slip.offset) for slip in record.slips)
    if record.error is not None:
        message = f"{statement.keyword}: {record.error.message}"
        slips.append(Slip(offset=statement.start + record.error.offset, message=message))
        return ()
    values = record.parts[0][1]
    expected = _ARITY[statement.keyword]
    if len(values) != expected:
        message = f"{statement.keyword} has {len(values)} parameters instead of {expected}"
        slips.append(Slip(offset=statement.start, message=message))
    return values


def _header(values: dict[str, tuple[Value, ...]]) -> Header:
    """Header of the statements' values, whatever their number."""
    description = [*values.get("FILE_DESCRIPTION", ()), None, None]
    name = [*values.get("FILE_NAME", ()), *[None] * 7]
    schemas = _texts(values.get("FILE_SCHEMA", ()))
    return Header(
        description=_texts(description[0]),
        implementation_level=_text(description[1]),
        name=_text(name[0]),
        time_stamp=_text(name[1]),
        author=_texts(name[2]),
        organisation=_texts(name[3]),
        preprocessor_version=_text(name[4]),
        originating_system=_text(name[5]),
        authorisation=_text(name[6]),
        schemas=tuple(schema for schema in schemas if schema.strip()),
    )


def _text(value: Value) -> str:
    """The string, or the only string of a list."""
    return " ".join(_texts(value))


def _texts(value: Value) -> tuple[str, ...]:
    """All strings in a value, in order."""
    found: list[str] = []
    pending = [value]
    while pending:
        item = pending.pop()
        if isinstance(item, tuple):
            pending.extend(reversed(item))
        elif isinstance(item, str):
            found.append(item)
    return tuple(found)
