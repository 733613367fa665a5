"""Words on the command line that say which outcomes are meant. Imports nothing slow."""

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
    group = parser.add_argument_group("outcomes with all of these")
    add = group.add_argument
    for name, what in (
        ("machine", "as outcomes name it"),
        ("material", "as outcomes name it"),
        ("tool", "as outcomes name it"),
        ("feature-kind", "EXPRESS name: closed_pocket, slot, planar_face …"),
        ("program", "file name"),
        ("run", "id of the run"),
    ):
        # `run` is what a command does.
        dest = "run_id" if name == "run" else name.replace("-", "_")
        add(f"--{name}", dest=dest, type=text, metavar="NAME", help=what)
    add(
        "--since",
        type=moment,
        metavar="TIME",
        help="recorded then or later: 2026-03-05, 2026-03-05T14:30 or with a zone, +01:00 "
        "(default: the zone of this computer)",
    )
    add(
        "--until",
        type=end,
        metavar="TIME",
        help="recorded before it; a day counts to its end",
    )


def request_of(kind: "type[S]", options: argparse.Namespace) -> "S":
    """A request with the outcomes that are meant.

    Raises
    ------
    StepNcError
        When no time lies between the two.
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
    """The outcomes that are meant.

    Raises
    ------
    StepNcError
        As :func:`request_of`.
    """
    from service.requests.knowledge import SelectionRequest

    return request_of(SelectionRequest, options).selection


def moment(word: str) -> datetime:
    """A time; a day means its beginning.

    Raises
    ------
    ArgumentTypeError
        When it is none.
    """
    try:
        return _zoned(datetime.fromisoformat(word))
    except (ValueError, OverflowError) as error:
        raise argparse.ArgumentTypeError(
            f"{word!r} is no time: 2026-03-05, or 2026-03-05T14:30+01:00"
        ) from error


def end(word: str) -> datetime:
    """A time; a day means its end.

    Raises
    ------
    ArgumentTypeError
        When it is none.
    """
    try:
        day = date.fromisoformat(word)
        return _zoned(datetime.combine(day + timedelta(days=1), time()))
    except OverflowError as error:
        raise argparse.ArgumentTypeError(f"{word!r} is no time that counts") from error
    except ValueError:
        return moment(word)


def _zoned(when: datetime) -> datetime:
    """With the zone of this computer where none is given; it has a name in UTC."""
    zoned = when.astimezone()
    zoned.timestamp()
    return zoned


def count(word: str) -> int:
    """A whole number from 0.

    Raises
    ------
    ArgumentTypeError
        When it is none.
    """
    try:
        number = int(word)
    except ValueError:
        number = -1
    if not 0 <= number <= MOST:
        raise argparse.ArgumentTypeError(f"{word!r} is no number from 0 to {MOST}")
    return number


MOST = 1_000_000_000


def share(word: str) -> float:
    """A share, 0.25 or 25%.

    Raises
    ------
    ArgumentTypeError
        When it is none.
    """
    try:
        number = float(word.removesuffix("%")) / (100.0 if word.endswith("%") else 1.0)
    except ValueError:
        number = -1.0
    if not 0.0 <= number <= 1.0:
        raise argparse.ArgumentTypeError(f"{word!r} is no share from 0 to 1, or 0% to 100%")
    return number
