"""Exit codes and options that several commands share. Imports nothing slow."""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

OK, BAD_INPUT, INFEASIBLE, LIMIT_EXCEEDED, INTERRUPTED = 0, 3, 4, 5, 130

CONTROLS = "linuxcnc, fanuc, haas, sinumerik, heidenhain or canonical"

if TYPE_CHECKING:
    Commands = argparse._SubParsersAction["CommandParser"]
else:
    Commands = object


class CommandParser(argparse.ArgumentParser):
    """Parser of one command; its options are added at its first use, so that others start."""

    fill: Callable[["CommandParser"], None] | None = None
    """adds the options"""

    def complete(self) -> None:
        """Add the options, once."""
        fill, self.fill = self.fill, None
        if fill is not None:
            fill(self)

    def parse_known_args(self, *args: Any, **words: Any) -> Any:
        """See the base class."""
        self.complete()
        return super().parse_known_args(*args, **words)


def add_file(parser: argparse.ArgumentParser) -> None:
    """The program, and the units it is written in."""
    parser.add_argument("file", type=Path, metavar="FILE", help="a STEP-NC program (Part 21)")
    parser.add_argument(
        "--units",
        default="iso",
        help="units of feeds and speeds in the file: iso (m/s, rev/s; default), rpm-mmin, "
        "rpm-mmtooth, rpm-mmrev, revs-mmtooth or revs-mmrev",
    )


def add_json(parser: argparse.ArgumentParser) -> None:
    """JSON instead of a table."""
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")


def text(word: str) -> str:
    """A word of the command line; bytes that are no text are none.

    Raises
    ------
    ArgumentTypeError
        When no file and no database could hold it.
    """
    try:
        word.encode()
    except UnicodeEncodeError as error:
        raise argparse.ArgumentTypeError(f"{word!r} is no text") from error
    return word


def add_knowledge(parser: argparse.ArgumentParser, why: str) -> None:
    """The knowledge base."""
    parser.add_argument(
        "--kb",
        type=text,
        default="",
        metavar="PLACE",
        help=f"knowledge base, a file or postgresql://…: {why} (default: $STEPNC_KB)",
    )
