"""Fields of requests: documentation, bounds and units, defined once.

A request is a frozen dataclass. Its fields are ``Annotated`` with :class:`About` and with
bounds of :mod:`annotated_types`. These define the options of the command line with their
help, the OpenAPI schemas, and the checks of values. Field names are keys in JSON.
"""

import argparse
from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, Field, dataclass, fields, replace
from enum import StrEnum
from pathlib import Path
from types import UnionType
from typing import (
    Annotated,
    Any,
    ClassVar,
    TypeVar,
    Union,
    get_args,
    get_origin,
    get_type_hints,
)

from annotated_types import Interval, MaxLen

from stepnc_model.errors import StepNcError

E = TypeVar("E", bound=StrEnum)
R = TypeVar("R", bound="Request")

NUMBERS = frozenset({int, float})

LONGEST_NAME = 200
"""Largest number of characters in a name."""


class FileUse(StrEnum):
    """Use of a file or folder by a command."""

    INPUT = "input"
    OUTPUT = "output"
    PROGRAM = "program"
    """Input whose kind decides which options serve."""


@dataclass(frozen=True, slots=True)
class About:
    """Documentation of a field."""

    text: str
    """Description for help texts and OpenAPI."""
    unit: str = ""
    name: str = ""
    """Name of the field in messages; empty: the attribute's name."""
    flag: str = ""
    """Option on the command line; empty: none."""
    short: str = ""
    """Short form of the option, as "-o"."""
    use: "FileUse | None" = None
    """How a file or folder is used; None: the value is none."""
    group: str = ""
    """Heading in the help under which the option stands; empty: the general ones."""
    one_of: str = ""
    """Name of a set of options of which exactly one must be given; empty: of none."""
    metavar: str | None = None
    examples: tuple[object, ...] = ()
    is_word: bool = False
    """True for a value that the command line takes without an option, as it does files."""
    read: Callable[[str], object] | None = None
    """Reads the text of the option; None: its type tells how. Values in JSON never pass it."""

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        """Return the JSON schema with description and examples; called by pydantic."""
        found: dict[str, Any] = {**handler(schema), "description": self.text}
        if self.examples:
            found["examples"] = list(self.examples)
        return found


@dataclass(frozen=True, slots=True)
class Request:
    """Base class of all requests."""

    __pydantic_config__: ClassVar[dict[str, Any]] = {"extra": "forbid"}


@dataclass(frozen=True, slots=True, kw_only=True)
class RequestField:
    """Field of a request with the information from its type annotation."""

    name: str
    kind: Any
    """Type of the value, or of the members of a sequence."""
    is_sequence: bool
    is_optional: bool
    about: About
    bounds: tuple[Any, ...]
    member_bounds: tuple[Any, ...]
    """Bounds of the members of a sequence."""
    default: Any

    @property
    def is_word(self) -> bool:
        """True for what the command line takes without an option."""
        return (self.about.is_word or self.about.use is not None) and not self.about.flag

    @property
    def is_typed(self) -> bool:
        """True for what the command line takes."""
        return self.is_word or bool(self.about.flag)

    @property
    def label(self) -> str:
        """Name of the field in messages."""
        return self.about.name or self.name.replace("_", " ")


def fields_of(kind: type[Request]) -> list[RequestField]:
    """Return the documented fields of a request."""
    hints = get_type_hints(kind, include_extras=True)
    return [found for each in fields(kind) if (found := _field(each, hints[each.name]))]


def _field(field: Field[Any], hint: Any) -> RequestField | None:
    if get_origin(hint) is not Annotated:
        return None
    kind, *extras = get_args(hint)
    about = next((each for each in extras if isinstance(each, About)), None)
    if about is None:
        return None
    is_optional = get_origin(kind) in {Union, UnionType}
    if is_optional:
        kind = next(each for each in get_args(kind) if each is not type(None))
    is_sequence = get_origin(kind) is tuple
    if is_sequence:
        kind = get_args(kind)[0]
    members: Sequence[Any] = ()
    if get_origin(kind) is Annotated:
        kind, *members = get_args(kind)
    default = field.default if field.default_factory is MISSING else field.default_factory()
    return RequestField(
        name=field.name,
        kind=kind,
        is_sequence=is_sequence,
        is_optional=is_optional,
        about=about,
        bounds=tuple(extras),
        member_bounds=tuple(members) if is_sequence else (),
        default=default,
    )


def text(word: str) -> str:
    """Type of an argument that is text.

    Raises
    ------
    ArgumentTypeError
        When it cannot be encoded as UTF-8.
    """
    try:
        word.encode()
    except UnicodeEncodeError as error:
        raise argparse.ArgumentTypeError(f"{word!r} is not valid text") from error
    return word


def output_path(word: str) -> Path:
    """Type of an argument that names a file or folder to be written.

    The places of a command's outputs are told from those of its inputs by this type, and
    compared before it starts (:mod:`service.cli.commands`).
    """
    return Path(word)


def add_options(
    parser: argparse.ArgumentParser,
    kind: type[Request],
    *,
    usual: Mapping[str, object] | None = None,
) -> None:
    """Add a command-line option for each field of a request that has a flag.

    Parameters
    ----------
    kind : type
    usual : mapping, optional
        Command-specific default values, by field name.
    """
    groups: dict[str, Any] = {"": parser}
    for each in fields_of(kind):
        field = replace(each, default=(usual or {}).get(each.name, each.default))
        about = field.about
        if not field.is_typed:
            continue
        if about.group not in groups:
            groups[about.group] = _group(parser, about.group)
        place = groups[about.group]
        if about.one_of:
            way = f"one of {about.one_of}"
            place = groups.setdefault(way, None) or place.add_mutually_exclusive_group(
                required=True
            )
            groups[way] = place
        _add_option(place, field)


def _group(parser: argparse.ArgumentParser, title: str) -> Any:
    """Group of options with a title; two requests of a command may share it."""
    known = {each.title: each for each in parser._action_groups}
    return known.get(title) or parser.add_argument_group(title)


def _add_option(parser: Any, field: RequestField) -> None:
    """Add one option, or a word that is named without an option."""
    about = field.about
    words: dict[str, Any] = {"metavar": about.metavar, "help": _help(field)}
    if field.kind is Path:
        words["type"] = output_path if about.use is FileUse.OUTPUT else Path
    elif (
        field.kind in NUMBERS
        and about.read is None
        and (field.is_word or not field.is_sequence)
    ):
        words["type"] = field.kind
    elif field.kind is not bool:
        words["type"] = text
    if field.is_word:
        least = "+" if field.default is MISSING else "*"
        nargs = least if field.is_sequence else "?" if field.is_optional else None
        parser.add_argument(field.name, nargs=nargs, **words)
        return
    words |= {"dest": field.name, "default": None}
    if field.kind is bool:
        del words["metavar"]
        words |= {"action": "store_true", "default": False}
    elif field.is_sequence and not field.default and not field.is_optional:
        words |= {"action": "append", "default": []}
    elif field.default is MISSING:
        words["required"] = True
    parser.add_argument(*filter(None, (about.short, about.flag)), **words)


def _help(field: RequestField) -> str:
    """Return the help text of an option, including its default."""
    text = field.about.text.replace("%", "%%")
    shown = field.default
    is_none = shown is None or shown is MISSING or shown == ()
    if field.kind is bool or is_none or not str(shown):
        return text
    if isinstance(shown, tuple):
        shown = ",".join(map(str, shown))
    shown = str(shown).replace("%", "%%")
    return f"{text} (default: {shown})"


def from_options(kind: type[R], options: argparse.Namespace, **values: object) -> R:
    """Build a request from the parsed command-line options.

    Parameters
    ----------
    kind : type
    options : Namespace
        Options that :func:`add_options` has added.
    **values
        Values of fields without an option.

    Raises
    ------
    StepNcError
        When a word is not a value of its field.
    """
    for field in fields_of(kind):
        typed = getattr(options, field.name, None) if field.is_typed else None
        if typed is not None and typed != []:
            values[field.name] = _read(field, typed)
    return kind(**values)


def _read(field: RequestField, typed: Any) -> Any:
    """Convert option text to a field value; sequences are split at commas, or repeated."""
    if field.is_sequence:
        words = typed if isinstance(typed, list) else typed.split(",")
        return tuple(_member(field, _stripped(word)) for word in words)
    return _member(field, typed)


def _stripped(word: str | Path) -> str | Path:
    return word.strip() if isinstance(word, str) else word


def _member(field: RequestField, typed: Any) -> Any:
    if field.about.read is not None:
        return field.about.read(typed)
    if isinstance(field.kind, type) and issubclass(field.kind, StrEnum):
        return member_of(field.kind, typed, field.label)
    if field.kind is float and isinstance(typed, str):
        try:
            return float(typed)
        except ValueError:
            raise StepNcError(f"{field.label} '{typed}': expected a number") from None
    return typed


def member_of(kind: type[E], word: str, label: str) -> E:
    """Return the enumeration member with the given value, ignoring case.

    A hyphen stands for a space, which needs quotes on the command line.

    Raises
    ------
    StepNcError
        When no member has this value.
    """
    for member in kind:
        if member.value.lower().replace(" ", "-") == word.lower().replace(" ", "-"):
            return member
    known = ", ".join(member.value for member in kind)
    raise StepNcError(f"unknown {label} '{word}'; known: {known}")


def require_bounds(request: Request) -> None:
    """Check that all values are within their bounds.

    Raises
    ------
    StepNcError
        With name, value, bound and unit of the first value out of bounds; or with options of
        which not exactly one is given.
    """
    _require_one_option_of_set(request)
    for field in fields_of(type(request)):
        value = getattr(request, field.name)
        if value is None:
            continue
        for bound in field.bounds:
            _require_within(value, bound, field)
        for bound in field.member_bounds:
            for member in value:
                _require_within(member, bound, field)


def _require_within(value: Any, bound: Any, field: RequestField) -> None:
    if words := _broken(value, bound):
        unit = f" {field.about.unit}" if field.about.unit else ""
        shown = f"{value:g}" if isinstance(value, int | float) else f"of {len(value)}"
        raise StepNcError(f"{field.label} {shown}{unit}: it must be {words}{unit}")


def _require_one_option_of_set(request: Request) -> None:
    ways: dict[str, list[RequestField]] = {}
    for field in fields_of(type(request)):
        if field.about.one_of:
            ways.setdefault(field.about.one_of, []).append(field)
    for fields_of_way in ways.values():
        given = [each for each in fields_of_way if getattr(request, each.name) != each.default]
        if len(given) != 1:
            names = " and ".join(each.name for each in fields_of_way)
            raise StepNcError(f"give one of {names}; given: {len(given)}")


def _broken(value: Any, bound: Any) -> str:
    """Return the bound in words if a value breaks it, else an empty text."""
    match bound:
        case Interval(gt=gt, ge=ge, lt=lt, le=le):
            is_low = (gt is None or value > gt) and (ge is None or value >= ge)
            if is_low and (lt is None or value < lt) and (le is None or value <= le):
                return ""
            low = f"{ge:g}" if gt is None else f"above {gt:g}"
            return f"{low} to {le:g}" if lt is None else f"at least {low} and below {lt:g}"
        case MaxLen(max_length=most) if len(value) > most:
            return f"at most {most} long"
    return ""


def dumped(request: Request) -> dict[str, Any]:
    """Return the values for JSON, by field name."""
    from pydantic import TypeAdapter  # noqa: PLC0415 (slow to import)

    found: dict[str, Any] = TypeAdapter(type(request)).dump_python(request, mode="json")
    return found


def loaded(kind: type[R], values: Mapping[str, Any]) -> R:
    """Build a request from its stored values.

    Raises
    ------
    StepNcError
        When the values do not fit the request.
    """
    from pydantic import TypeAdapter, ValidationError  # noqa: PLC0415 (slow to import)

    try:
        return TypeAdapter(kind).validate_python(dict(values))
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"]))
        raise StepNcError(f"{place}: {first['msg']}") from error
