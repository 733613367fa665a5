"""Calling a verb with values of Python: its request and files from keywords.

Verbs by name: each is a folder below this one.

A folder holds

- ``__init__.py``, whose docstring is the help: a sentence, then examples and details;
- ``request.py`` with ``REQUEST``, the type of the values that every door takes, and ``FILES``,
  that of the files that command line and Python name (``USUAL``: values that differ from those
  of REST where nothing is asked for);
- ``run.py`` with ``run(request, files, *, tell)``, which returns a
- :class:`~service.verbs.result.Result`, declared in ``result.py``.

A folder is all that a verb needs: doors find it by its name. Verbs of two words, as
``kbe review``, share the folder of the first, whose docstring is the help of the group. Verbs
of an extra are folders of its ``verbs``.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import MISSING, dataclass
from difflib import get_close_matches
from enum import StrEnum
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

from service.extra_parts import EXTRAS
from service.progress import Tell, silent
from service.requests.fields import (
    NUMBERS,
    FileUse,
    Request,
    RequestField,
    fields_of,
    member_of,
    require_bounds,
)
from service.requests.kind_options import require_options_served
from service.requests.output import OutputFiles
from service.verbs.result import DoneResult, Result
from stepnc_model.errors import StepNcError

HERE = Path(__file__).parent


@dataclass(frozen=True, slots=True, kw_only=True)
class Verb:
    """A verb, whose parts are imported when they are needed; or a group, of its help alone."""

    folder: str
    """Its folder below the package, with a dot between two names."""
    package: str = "service.verbs"
    """Package that its folder lies in: this one, or that of an extra."""

    @property
    def name(self) -> str:
        """Name on the command line, such as ``kbe review``."""
        return self.folder.replace(".", " ")

    @property
    def function(self) -> str:
        """Name in Python, such as ``kbe_review``."""
        return self.folder.replace(".", "_")

    @property
    def group(self) -> str:
        """First word of the name."""
        return self.folder.partition(".")[0]

    @property
    def about(self) -> str:
        """Help: a sentence, and details after an empty line."""
        return import_module(f"{self.package}.{self.folder}").__doc__ or ""

    @property
    def line(self) -> str:
        """First sentence of the help, without its full stop."""
        return " ".join(self.about.partition("\n\n")[0].split()).removesuffix(".")

    @property
    def details(self) -> str:
        """The rest of the help; empty if there is none."""
        return self.about.partition("\n\n")[2].strip()

    @property
    def request(self) -> type[Request]:
        """Type of its request."""
        found: type[Request] = self._part("request").REQUEST
        return found

    @property
    def files(self) -> type[Request]:
        """Type of its files."""
        found: type[Request] = self._part("request").FILES
        return found

    @property
    def usual(self) -> Mapping[str, object]:
        """Values of the request that are usual on the command line and in Python."""
        found: Mapping[str, object] = getattr(self._part("request"), "USUAL", {})
        return found

    @property
    def run(self) -> Callable[..., Result]:
        """Function that does the work."""
        found: Callable[..., Result] = self._part("run").run
        return found

    def module(self, name: str) -> str:
        """Dotted name of one of its modules, such as ``run``."""
        return f"{self.package}.{self.folder}.{name}"

    def _part(self, name: str) -> ModuleType:
        return import_module(self.module(name))


@cache
def verbs() -> dict[str, Verb]:
    """Return all verbs by the names of their folders, in alphabetical order."""
    folders = (each.parent.relative_to(HERE).parts for each in HERE.rglob("request.py"))
    core = {name: Verb(folder=name) for name in map(".".join, folders)}
    added = {
        file.parts[-2]: Verb(folder=file.parts[-2], package=f"extras.{file.parts[-4]}.verbs")
        for file in EXTRAS.glob("*/verbs/*/request.py")
    }
    return dict(sorted((core | added).items()))


def call(
    verb: Verb, args: Sequence[object], words: Mapping[str, object], *, tell: Tell = silent
) -> Result:
    """Run a verb.

    Parameters
    ----------
    args : sequence
        Words that the command line takes without an option, in its order.
    words : mapping
        Values by the names of the fields of its request and its files.
    tell : callable
        Receives messages.

    Raises
    ------
    TypeError
        When a name is not one of a field, a value is missing, or has another type.
    StepNcError
        When a value is not valid; and as the verb.
    """
    of_files, of_request = fields_of(verb.files), fields_of(verb.request)
    places = [each.name for each in (*of_files, *of_request) if each.is_word]
    if len(args) > len(places):
        raise TypeError(f"{verb.function}() takes {len(places)} positional arguments")
    given = dict(zip(places, args, strict=False))
    if twice := sorted(given.keys() & words.keys()):
        raise TypeError(f"{verb.function}() got {twice[0]} twice")
    given |= words
    known = {each.name for each in (*of_files, *of_request)}
    for name in given:
        if name not in known:
            near = get_close_matches(name, known, n=3)
            hint = f"; near to it: {', '.join(near)}" if near else ""
            raise TypeError(f"{verb.function}() has no argument '{name}'{hint}")
    request = _built(verb.request, of_request, {**verb.usual, **given})
    require_bounds(request)
    files = _built(verb.files, of_files, given)
    require_bounds(files)
    return ran(verb, request, files, named=given, tell=tell)


def ran(
    verb: Verb,
    request: Request,
    files: Request,
    *,
    named: Mapping[str, object],
    tell: Tell,
) -> Result:
    """Run a verb with its request and files, and write its result where a file is named.

    Parameters
    ----------
    named : mapping
        Values that the caller named, by their fields; those that do not serve the kind of
        program are refused, even if they are the usual ones.
    tell : callable
        Receives messages.

    Raises
    ------
    StepNcError
        When a value does not serve the program; and as the verb.
    """
    _require_served((*fields_of(verb.files), *fields_of(verb.request)), files, named)
    if isinstance(files, OutputFiles):
        files.require_format()
    result = verb.run(request, files, tell=tell)
    if isinstance(files, OutputFiles) and files.output is not None:
        tell(f"written: {result.save(files.output, files.format)}")
    if isinstance(result, DoneResult):
        tell(result.said)
    report: Path | None = getattr(files, "report", None)
    if report is not None:
        from service.files import write_atomically  # noqa: PLC0415 (only where one is written)

        write_atomically(report, result.page().encode(errors="replace"))
        tell(f"report: {report}")
    return result


def _require_served(
    fields: Sequence[RequestField], files: Request, named: Mapping[str, object]
) -> None:
    """Refuse values that the kind of program cannot use."""
    flags = {each.name: each.about.flag for each in fields}
    for field in fields:
        program = getattr(files, field.name, None)
        if field.about.use is FileUse.PROGRAM and isinstance(program, Path):
            from service.inputs.program_kind import ProgramKind, kind_of_file  # noqa: PLC0415 (help)

            kind = ProgramKind.STEP_NC if program.is_dir() else kind_of_file(program)
            require_options_served(named, kind, flags=flags)


def _built(
    kind: type[Request], fields: Iterable[RequestField], named: Mapping[str, object]
) -> Request:
    """Build a request or files from the values that belong to them."""
    values = {}
    for field in fields:
        if field.name in named:
            values[field.name] = value_of(field, named[field.name])
        elif field.default is MISSING:
            raise TypeError(f"the argument '{field.name}' is missing: {field.about.text}")
    return kind(**values)


def value_of(field: RequestField, value: object) -> Any:
    """Convert a value of Python to that of a field; words are read as on the command line.

    Raises
    ------
    TypeError
        When it has another type.
    StepNcError
        When a word is none of the field's.
    """
    if value is None:
        if field.is_optional or field.default is None:
            return None
        raise TypeError(f"{field.name} must not be None")
    if not field.is_sequence:
        return _member(field, value)
    if isinstance(value, str):
        value = [word.strip() for word in value.split(",")]
    elif not isinstance(value, Iterable):
        value = [value]
    return tuple(_member(field, each) for each in value)


def _member(field: RequestField, value: object) -> Any:
    """Convert one value."""
    kind = field.kind
    if field.about.read is not None and isinstance(value, str | Path):
        return field.about.read(str(value))
    if isinstance(kind, type) and issubclass(kind, StrEnum):
        return member_of(kind, str(value), field.label)
    if kind is Path and isinstance(value, str | Path):
        return Path(value)
    if kind is bool and isinstance(value, bool):
        return value
    if kind in NUMBERS and isinstance(value, int | float) and not isinstance(value, bool):
        if kind is int and not float(value).is_integer():
            raise StepNcError(f"{field.label} {value:g}: expected a whole number")
        return kind(value)
    if kind is str and isinstance(value, str | Path):
        return str(value)
    if kind in {bool, Path, str, *NUMBERS}:
        raise TypeError(f"{field.name} is a {kind.__name__}, not {value!r}")
    return value
