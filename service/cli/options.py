"""Options that several commands share. Imports nothing slow."""

import argparse
import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from service.exit_codes import BAD_INPUT, INFEASIBLE, LIMIT_EXCEEDED, NOTHING_ADVISED, OK
from service.requests.fields import output_path

__all__ = ["BAD_INPUT", "INFEASIBLE", "LIMIT_EXCEEDED", "NOTHING_ADVISED", "OK"]

if TYPE_CHECKING:
    Commands = argparse._SubParsersAction["CommandParser"]
else:
    Commands = object


class CommandParser(argparse.ArgumentParser):
    """Parser of one command; its options are added on first use, to keep start-up fast."""

    fill: Callable[["CommandParser"], None] | None = None
    """Function that adds the options."""

    def __init__(self, *args: Any, **words: Any) -> None:
        super().__init__(*args, **words)
        # Coordinates may be negative: "-3,-3,-40,153,93,2" is not an option.
        self._negative_number_matcher = re.compile(r"-[.\d]")

    def complete(self) -> None:
        """Add the options, unless they were added before."""
        fill, self.fill = self.fill, None
        if fill is not None:
            fill(self)

    def parse_known_args(self, *args: Any, **words: Any) -> Any:
        """Parse known arguments after adding the options; note which of them are outputs."""
        self.complete()
        namespace, rest = super().parse_known_args(*args, **words)
        if names := output_names(self):
            namespace.output_names = names
        namespace.flags = {
            each.dest: each.option_strings[-1] for each in self._actions if each.option_strings
        }
        return namespace, rest


def output_names(parser: argparse.ArgumentParser) -> tuple[str, ...]:
    """Names of the arguments of a command that are outputs."""
    return tuple(each.dest for each in parser._actions if each.type is output_path)


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
