"""Command-line options that select outcomes of the knowledge base. Imports nothing slow."""

import argparse
from datetime import date, datetime, time, timedelta
from typing import TYPE_CHECKING, TypeVar

from service.cli.options import text
from stepnc_model.errors import StepNcError

if TYPE_CHECKING:
    from kbe.selection import Selection
    from service.requests.knowledge import SelectionRequest

S = TypeVar("S", bound="SelectionRequest")


def add_place(parser: argparse.ArgumentParser) -> None:
    """Add the option that names a knowledge base."""
    parser.add_argument(
        "--kb",
        type=text,
        default="",
        metavar="PLACE",
        help="a file, or postgresql://USER@HOST/DATABASE (default: $STEPNC_KB, else "
        "~/.local/share/stepnc/knowledge.db)",
    )


def add_filters(parser: argparse.ArgumentParser) -> None:
    """Add the options that select outcomes."""
    group = parser.add_argument_group("select outcomes that match all of these")
    add = group.add_argument
    for name, what in (
        ("machine", "name as in the outcomes"),
        ("material", "name as in the outcomes"),
        ("tool", "name as in the outcomes"),
        ("feature-kind", "EXPRESS name: closed_pocket, slot, planar_face …"),
        ("program", "file name"),
        ("run", "id of the run"),
    ):
        # `options.run` is the function of a command.
        dest = "run_id" if name == "run" else name.replace("-", "_")
        add(f"--{name}", dest=dest, type=text, metavar="NAME", help=what)
    add(
        "--since",
        type=moment,
        metavar="TIME",
        help="recorded then or later: 2026-03-05, 2026-03-05T14:30, or with a zone as +01:00 "
        "(default: the local time zone)",
    )
    add(
        "--until",
        type=end,
        metavar="TIME",
        help="recorded before this time; a date includes the whole day",
    )


def request_of(kind: "type[S]", options: argparse.Namespace) -> "S":
    """Build a request that selects outcomes by the parsed options.

    Raises
    ------
    StepNcError
        When --since is not before --until.
    """
    since, until = options.since, options.until
    if since is not None and until is not None and since >= until:
        raise StepNcError(f"--since {since} is not before --until {until}")
    return kind(
        machine=options.machine,
        material=options.material,
        tool=options.tool,
        feature_kind=options.feature_kind,
        program=options.program,
        run=options.run_id,
        since=since,
        until=until,
    )


def selection_of(options: argparse.Namespace) -> "Selection":
    """Return the selection of outcomes by the parsed options.

    Raises
    ------
    StepNcError
        As :func:`request_of`.
    """
    from service.requests.knowledge import SelectionRequest

    return request_of(SelectionRequest, options).selection


def moment(word: str) -> datetime:
    """Parse a time; a date means the start of the day.

    Raises
    ------
    ArgumentTypeError
        When the text is not a time.
    """
    try:
        return _zoned(datetime.fromisoformat(word))
    except (ValueError, OverflowError) as error:
        raise argparse.ArgumentTypeError(
            f"{word!r} is not a time; write 2026-03-05 or 2026-03-05T14:30+01:00"
        ) from error


def end(word: str) -> datetime:
    """Parse a time; a date means the end of the day.

    Raises
    ------
    ArgumentTypeError
        When the text is not a time.
    """
    try:
        day = date.fromisoformat(word)
        return _zoned(datetime.combine(day + timedelta(days=1), time()))
    except OverflowError as error:
        raise argparse.ArgumentTypeError(f"{word!r} is not a supported time") from error
    except ValueError:
        return moment(word)


def _zoned(when: datetime) -> datetime:
    """Add the local time zone to a time without one; refuse times that have no UTC value."""
    zoned = when.astimezone()
    zoned.timestamp()
    return zoned


def count(word: str) -> int:
    """Parse a whole number of at least 0.

    Raises
    ------
    ArgumentTypeError
        When the text is not such a number.
    """
    try:
        number = int(word)
    except ValueError:
        number = -1
    if not 0 <= number <= MOST:
        raise argparse.ArgumentTypeError(f"{word!r} is not a whole number from 0 to {MOST}")
    return number


MOST = 1_000_000_000


def share(word: str) -> float:
    """Parse a share such as 0.25 or 25%.

    Raises
    ------
    ArgumentTypeError
        When the text is not a share.
    """
    try:
        number = float(word.removesuffix("%")) / (100.0 if word.endswith("%") else 1.0)
    except ValueError:
        number = -1.0
    if not 0.0 <= number <= 1.0:
        raise argparse.ArgumentTypeError(f"{word!r} is not a share from 0 to 1, or 0% to 100%")
    return number
