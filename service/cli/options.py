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
    """Parser of one command; its options are added on first use, to keep start-up fast."""

    fill: Callable[["CommandParser"], None] | None = None
    """Function that adds the options."""

    def complete(self) -> None:
        """Add the options, unless they were added before."""
        fill, self.fill = self.fill, None
        if fill is not None:
            fill(self)

    def parse_known_args(self, *args: Any, **words: Any) -> Any:
        """Parse known arguments after adding the options."""
        self.complete()
        return super().parse_known_args(*args, **words)


def add_file(parser: argparse.ArgumentParser) -> None:
    """Add the program file and the option for its units."""
    parser.add_argument("file", type=Path, metavar="FILE", help="a STEP-NC program (Part 21)")
    parser.add_argument(
        "--units",
        default="iso",
        help="units of feeds and speeds in the file: iso (m/s, rev/s; default), rpm-mmin, "
        "rpm-mmtooth, rpm-mmrev, revs-mmtooth, revs-mmrev, rpm-mmtooth-mmrev, "
        "revs-mmtooth-mmrev (per tooth in milling, per turn in drilling), or auto: the only "
        "ones in which all numbers are plausible",
    )


def add_json(parser: argparse.ArgumentParser) -> None:
    """Add the option for JSON output."""
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")


def text(word: str) -> str:
    """Return a command-line argument unchanged if it is valid text.

    Raises
    ------
    ArgumentTypeError
        When the argument cannot be encoded as UTF-8.
    """
    try:
        word.encode()
    except UnicodeEncodeError as error:
        raise argparse.ArgumentTypeError(f"{word!r} is not valid text") from error
    return word


def add_cluster(parser: argparse.ArgumentParser) -> None:
    """Add the option that names a Dask cluster."""
    parser.add_argument(
        "--cluster",
        type=text,
        default="",
        metavar="ADDRESS",
        help="run on the Dask cluster of this scheduler, tcp://127.0.0.1:8786 or, beyond this "
        "machine, tls://HOST:PORT (default: on processes of this machine)",
    )


def add_knowledge(parser: argparse.ArgumentParser, why: str) -> None:
    """Add the option that names the knowledge base."""
    parser.add_argument(
        "--kb",
        type=text,
        default="",
        metavar="PLACE",
        help=f"knowledge base, a file or postgresql://…: {why} (default: $STEPNC_KB)",
    )
