"""Typed reading and writing of the library's TOML files.

A file is declared as a :class:`FileTable`: the fields are its keys, with the unit in the name
and the allowed range in the type. msgspec checks types, ranges, and missing and unknown keys;
this module turns its findings into errors that name file, key, value and bound with unit.
Values stay in the units of the keys; the tables convert them.

Bounds of a TOML text, checked in one linear scan before the parser reads it.

The parser's time and memory grow with the square of the parts of a dotted key, and its calls
nest as brackets do: 64 KB of ``a.a.a`` cost it 4 GB. Within these bounds its cost is in
proportion to the size. Strings and comments are passed over; what stands in them never counts.
The scan has to agree with the parser only up to the first fault of a text, where the parser
stops.
"""

import json
import re
import tomllib
from collections.abc import Callable, Iterator, Sequence
from math import inf, isfinite, nextafter
from pathlib import Path
from typing import Any, TypeVar

import msgspec
from msgspec import inspect

from simulator.errors import LibraryError
from stepnc_model.regular_file import open_regular

MOST_BYTES = 1 << 19
"""of a file; the library's have 3 KB, a tool table of 400 tools has 100 KB"""

MOST_PARTS = 20
"""of a dotted key or table header; the library's have 2"""

MOST_NESTED = 20
"""arrays and inline tables within one another; the library's nest 2 deep"""

LONGEST_WORD = 400
"""letters of a key without quotes, or digits of a number: the largest float has 309"""

_TOKEN = re.compile(
    r'"""(?>(?:[^"\\]++|\\.|"(?!""))*)(?:"{3,5})?'
    r"|'''.*?(?:'{3,5}|\Z)"
    r'|"(?>(?:[^"\\\n]++|\\.)*)"?'
    r"|'[^'\n]*+'?"
    r"|\#[^\n]*+"
    r"|(?P<word>[A-Za-z0-9_+-]++)"
    r"|(?P<dot>\.)|(?P<open>[\[{])|(?P<close>[\]}])|(?P<next>[\n=,])",
    re.DOTALL,
)


def require_bounded(text: str, path: Path) -> None:
    """Refuse a text that may cost the parser more than in proportion to its size.

    Raises
    ------
    LibraryError
        With the line, the value and the bound.
    """
    parts, nested = 1, 0
    for match in _TOKEN.finditer(text):
        kind = match.lastgroup
        if kind == "dot":
            parts += 1
            if parts > MOST_PARTS:
                _refuse(text, match, path, f"a key of more than {MOST_PARTS} dotted parts")
        elif kind == "word":
            if len(match[0]) > LONGEST_WORD:
                what = f"a key or number of {len(match[0])} letters; at most {LONGEST_WORD}"
                _refuse(text, match, path, what)
        elif kind is not None:
            parts = 1
            nested += (kind == "open") - (kind == "close")
            if nested > MOST_NESTED:
                what = f"arrays and tables nested more than {MOST_NESTED} deep"
                _refuse(text, match, path, what)


def _refuse(text: str, match: re.Match[str], path: Path, what: str) -> None:
    """Raise the error at a token."""
    line = text.count("\n", 0, match.start()) + 1
    raise LibraryError(what, path=str(path), line=line)


LONGEST_SHOWN = 80
"""characters of a value or a key in a message"""

MOST_DIGITS = 17
"""significant digits that tell any two floats apart"""

T = TypeVar("T")
Conversion = Callable[[float], float]

_AT = re.compile(r" - at `\$([\w.\[\]]*)`$")
_FIELD = re.compile(r"Object (contains unknown|missing required) field `(.*)`$", re.DOTALL)


class FileTable(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A table of a file; its fields are the keys."""


class TableHead(msgspec.Struct, frozen=True, kw_only=True):
    """The first keys of a file; the others are not looked at."""


class KeyFault(ValueError):
    """A value of a key that contradicts other values of its table.

    Raised in ``__post_init__`` of a table. Any other ``ValueError`` there concerns the table as
    a whole.
    """

    def __init__(self, key: str, message: str) -> None:
        super().__init__(message)
        self.key = key


def quantity(low: float, high: float, unit: str = "") -> msgspec.Meta:
    """Range of a number, both ends included, with its unit for messages."""
    return msgspec.Meta(ge=low, le=high, extra={"unit": unit})


def complaint(value: object, kind: Any) -> str:
    """Complaint about a value of a type; empty when it is valid."""
    try:
        msgspec.convert(value, kind)
    except msgspec.ValidationError:
        return _complaint(value, _alternative(inspect.type_info(kind), value), "")
    return ""


def require_window(table: FileTable, low_key: str, high_key: str) -> None:
    """Refuse a window whose lower end lies above its upper end."""
    low, high = getattr(table, low_key), getattr(table, high_key)
    if low is not None and high is not None and low > high:
        types = {each.encode_name: each.type for each in _fields(type(table))}
        unit, _, _ = _range(_alternative(types[low_key], low))
        bound = f"{high_key} {_quantity(high, unit)}"
        raise KeyFault(low_key, f"{_quantity(low, unit)} exceeds {bound}")


def require_whole(table: FileTable, key: str) -> None:
    """Refuse a number with a fraction."""
    if (value := getattr(table, key)) != int(value):
        raise KeyFault(key, f"{value:g} is not a whole number")


def require_together(table: FileTable, *keys: str) -> None:
    """Refuse a table that has some of the keys and lacks others."""
    absent = [key for key in keys if getattr(table, key) is None]
    if absent and len(absent) < len(keys):
        given = next(key for key in keys if key not in absent)
        raise KeyFault(absent[0], f"missing; expected together with {given}")


def changed_keys(table: FileTable) -> list[str]:
    """Keys of a table whose value is not the default."""
    fields = msgspec.structs.fields(table)
    return [each.name for each in fields if getattr(table, each.name) != each.default]


def converted(
    content: object, kind: type[T], path: Path, *, name: str = "", line: int = 0
) -> T:
    """Content of a file as the table that it is declared to be.

    Parameters
    ----------
    content : object
        As the parser gave it.
    kind : type
        A :class:`FileTable`.
    path : Path
        The file, for messages.
    name : str
        Name of the whole content in messages; empty for the root of a TOML file.
    line : int
        Line of the content in messages; 0 if its keys give the place.

    Raises
    ------
    LibraryError
        A key is missing, unknown or has a value that is not allowed.
    """
    try:
        return msgspec.convert(content, kind)
    except msgspec.ValidationError as error:
        key, message = _fault(error, content, kind)
        place = ".".join(part for part in (name, key) if part)
        raise LibraryError(message, path=str(path), key=_cut(place), line=line) from error


def read_toml(path: Path, kind: type[T]) -> T:
    """A TOML file as a table."""
    return converted(parsed(read_text(path), path), kind, path)


def read_toml_head(path: Path, kind: type[T]) -> T:
    """Keys of the root alone, without the tables below.

    In TOML the keys of the root stand before the first table header, so the rest need not be
    parsed: names of all materials are read five times faster than the materials themselves.
    """
    return converted(parsed(read_text(path).split("\n[", maxsplit=1)[0], path), kind, path)


def read_text(path: Path) -> str:
    """Text of a library file in UTF-8."""
    try:
        return read_bounded(path).decode("utf-8").replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError as error:
        raise LibraryError(f"is not UTF-8 text: {error.reason}", path=str(path)) from error


def read_bounded(path: Path, *, most: int = MOST_BYTES) -> bytes:
    """Bytes of a library file, which is small."""
    try:
        with open_regular(path) as file:
            data = file.read(most + 1)
    except ValueError as error:
        raise LibraryError(
            f"is not a valid file name: {error}", path=repr(str(path))
        ) from error
    except OSError as error:
        raise LibraryError(f"cannot be read: {error.strerror}", path=str(path)) from error
    if len(data) > most:
        raise LibraryError(f"is larger than {most} bytes, the most", path=str(path))
    return data


def parsed(text: str, path: Path) -> dict[str, Any]:
    """Content of a TOML text within the bounds of the scan."""
    require_bounded(text, path)
    try:
        return tomllib.loads(text)
    except ValueError as error:
        # Also a date that is in no calendar, which is no TOMLDecodeError.
        raise LibraryError(f"is not valid TOML: {error}", path=str(path)) from error


def written(table: FileTable, *, name: str = "") -> list[str]:
    """Lines of a table: its own keys first, then the tables below.

    Keys without a value are left out, and so are texts, flags and lists at their default.
    """
    own: list[str] = []
    below: list[str] = []
    tag = table.__struct_config__.tag
    if isinstance(tag, str):
        own.append(f"{table.__struct_config__.tag_field} = {_text(tag)}")
    for field in msgspec.structs.fields(table):
        value, place = getattr(table, field.name), f"{name}.{field.name}".removeprefix(".")
        is_usual = not isinstance(value, float) and value == field.default
        if value is None or is_usual:
            continue
        if isinstance(value, FileTable):
            below += ["", f"[{place}]", *written(value, name=place)]
        elif isinstance(value, tuple) and isinstance(next(iter(value), None), FileTable):
            for row in value:
                below += ["", f"[[{place}]]", *written(row, name=place)]
        elif value != ():
            own += _key(field.name, value)
    return own + below


def shortest(value: float, shown: Conversion, read: Conversion) -> float:
    """Number of fewest digits in the unit of a key that reads as a canonical value.

    A value that no number in that unit converts to (the last bit of a quotient by 60) becomes
    the nearest one.
    """
    guess = shown(value)
    for digits in range(1, MOST_DIGITS + 1):
        rounded = float(f"{guess:.{digits}g}")
        if read(rounded) == value:
            return rounded
    # Two roundings may land beside the number that was read.
    beside = (nextafter(guess, inf), nextafter(guess, -inf))
    return next((number for number in beside if read(number) == value), guess)


def _key(key: str, value: object) -> Iterator[str]:
    """Lines of a key whose value is no table."""
    match value:
        case str():
            yield f"{key} = {_text(value)}"
        case bool():
            yield f"{key} = {str(value).lower()}"
        case float() if value.is_integer():
            yield f"{key} = {int(value)}"
        case tuple():
            yield from (f"{key} = [", *(f"    {_text(each)}," for each in value), "]")
        case _:
            yield f"{key} = {value!r}"


def _text(value: str) -> str:
    """A basic string; JSON's escapes are TOML's, save that TOML escapes DEL as well."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007F")


def _fault(error: msgspec.ValidationError, content: object, kind: Any) -> tuple[str, str]:
    """Key and message of what msgspec refused."""
    place = at[1] if (at := _AT.search(str(error))) else ""
    steps = re.findall(r"\w+|\[\d+\]", place)
    value, expected, shown = content, _alternative(inspect.type_info(kind), content), ""
    for step in steps:
        value, expected, shown = _below(value, expected, shown, step)
    cause = error.__cause__
    if isinstance(cause, KeyFault):
        return _joined(shown, cause.key), str(cause)
    if isinstance(cause, ValueError):
        return shown, str(cause)
    field = _FIELD.match(_AT.sub("", str(error)))
    if field is None:
        return shown, _complaint(value, expected, shown)
    fields = expected.fields if isinstance(expected, inspect.StructType) else ()
    known = {each.encode_name: each.type for each in fields}
    key = _joined(shown, field[2])
    if field[1] == "contains unknown":
        return key, f"unknown key; known here: {', '.join(sorted(known))}"
    wanted = known.get(field[2])
    if wanted is None:  # the key that tells the kinds of a table apart
        return key, "missing; expected a text"
    return key, f"missing; expected {_expected(_alternative(wanted, None))}"


def _below(
    value: Any, expected: inspect.Type, shown: str, step: str
) -> tuple[Any, inspect.Type, str]:
    """Value, type and name of what lies one step below; rows are counted from 1."""
    found: inspect.Type = inspect.AnyType()
    if step.startswith("["):
        row = int(step[1:-1])
        if isinstance(expected, inspect.VarTupleType):
            found = expected.item_type
        return value[row], _alternative(found, value[row]), f"{shown}[{row + 1}]"
    if isinstance(expected, inspect.StructType):
        types = {each.encode_name: each.type for each in expected.fields}
        found = types.get(step, found)
        if step == expected.tag_field:
            found = inspect.LiteralType(values=(expected.tag,))
    inner = value.get(step)
    return inner, _alternative(found, inner), _joined(shown, step)


def _fields(kind: type[FileTable]) -> tuple[inspect.Field, ...]:
    found = inspect.type_info(kind)
    return found.fields if isinstance(found, inspect.StructType) else ()


def _joined(place: str, key: str) -> str:
    return f"{place}.{key}" if place and key else place or key


def _alternative(kind: inspect.Type, value: object) -> inspect.Type:
    """The type of a union that a value is measured against; others as they are."""
    if not isinstance(kind, inspect.UnionType):
        return kind
    types = [each for each in kind.types if not isinstance(each, inspect.NoneType)]
    tagged = [each for each in types if isinstance(each, inspect.StructType)]
    for each in tagged:
        if isinstance(value, dict) and value.get(str(each.tag_field)) == each.tag:
            return each
    if len(tagged) > 1:
        tags = tuple(each.tag for each in tagged)
        first = tagged[0]
        own = inspect.Field("", str(first.tag_field), inspect.LiteralType(values=tags))
        return inspect.StructType(cls=first.cls, fields=(own,))
    return types[0]


def _range(kind: inspect.Type) -> tuple[str, float, float]:
    """Unit and bounds of a number."""
    unit = ""
    if isinstance(kind, inspect.Metadata):
        unit, kind = str((kind.extra or {}).get("unit", "")), kind.type
    low, high = getattr(kind, "ge", None), getattr(kind, "le", None)
    return unit, -inf if low is None else low, inf if high is None else high


def _quantity(value: float, unit: str) -> str:
    return f"{value:g} {unit}".rstrip()


def _expected(kind: inspect.Type) -> str:
    """A type in words."""
    inner = kind.type if isinstance(kind, inspect.Metadata) else kind
    match inner:
        case inspect.FloatType() | inspect.IntType():
            unit, low, high = _range(kind)
            return f"a number, {low:g} to {_quantity(high, unit)}"
        case inspect.BoolType():
            return "true or false"
        case inspect.StructType():
            return "a table"
        case inspect.VarTupleType(item_type=inspect.StrType()):
            return "a list of texts"
        case inspect.VarTupleType():
            return "an array of tables"
        case _:
            return "a text"


def _complaint(value: object, kind: inspect.Type, place: str) -> str:
    """Complaint about a value that is of another type or out of its range."""
    inner = kind.type if isinstance(kind, inspect.Metadata) else kind
    match inner:
        case inspect.FloatType():
            return _number_complaint(value, kind)
        case inspect.BoolType():
            return f"{_shown(value)} is neither true nor false"
        case inspect.EnumType() | inspect.LiteralType() if isinstance(value, str):
            enumeration = getattr(inner, "cls", None)
            known: Sequence[Any] = getattr(inner, "values", None) or list(enumeration or ())
            return f"'{_cut(value)}' is not one of {', '.join(map(str, filter(None, known)))}"
        case inspect.StructType():
            return f"{_shown(value)} is not a table"
        case inspect.VarTupleType(item_type=inspect.StrType()):
            return f"{_shown(value)} is not a list of texts"
        case inspect.VarTupleType():
            return f"is not an array of tables; write [[{place}]]"
        case _:
            return f"{_shown(value)} is not a text"


def _number_complaint(value: object, kind: inspect.Type) -> str:
    unit, low, high = _range(kind)
    allowed = f"{low:g} to {_quantity(high, unit)}"
    if isinstance(value, bool) or not isinstance(value, int | float):
        return f"{_shown(value)} is not a number; expected {allowed}"
    try:
        number = float(value)
    except OverflowError:
        return f"{_shown(value)} is beyond the range of a number; expected {allowed}"
    if not isfinite(number):
        return f"{number} is not a finite number; expected {allowed}"
    if number < low:
        return f"{_quantity(number, unit)} is below {_quantity(low, unit)}"
    return f"{_quantity(number, unit)} exceeds {_quantity(high, unit)}"


def _shown(value: object) -> str:
    """A value for a message."""
    return _cut(repr(value))


def _cut(text: str) -> str:
    """A text that may be long, for a message."""
    return text if len(text) <= LONGEST_SHOWN else f"{text[: LONGEST_SHOWN - 1]}…"
