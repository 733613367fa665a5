"""Ctrl-C at moments that are drawn from the whole start of a command."""

import signal
from collections.abc import Callable
from itertools import count
from pathlib import Path
from random import Random

import pytest

from service.cli.interrupts import INTERRUPTED
from tests.extras.factory.shops import program_file
from tests.extras.learning.test_dataset_run import DESIGN
from tests.service.cli.command import PARTS, command


def design(folder: Path) -> str:
    """Design of a data set."""
    file = folder / "design.toml"
    file.write_text(DESIGN, encoding="utf-8")
    return str(file)


def shop(folder: Path) -> str:
    """A shop."""
    return str(program_file(folder))


FIRST = 100
"""Line from which on the modules are those of the command, not of the interpreter."""

PART = str(PARTS / "paper000.stpnc")

VERBS: dict[str, tuple[Callable[[Path], list[str]], str, int]] = {
    "agent": (
        lambda _: ["agent", PART, "--machine", "paper000", "--port", "0"],
        "MTConnect agent: ",
        1200,
    ),
    "dataset": (lambda at: ["dataset", design(at), "-n", "30", "-o", "rows"], "rows", 1600),
    "factory": (
        lambda at: ["factory", shop(at), "--replications", "4", "--hours", "500"],
        " of 500 h",
        1600,
    ),
    "live": (
        lambda at: ["factory", shop(at), "--live", "--port", "0"],
        "MTConnect agent: ",
        1200,
    ),
    "serve": (
        lambda at: ["serve", "--port", "0", "--data", str(at / "data")],
        "Application startup complete",
        2500,
    ),
}
"""Words, a line when it has started, and about the number of lines until then."""


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("verb", VERBS)
def test_ctrl_c_anywhere_in_the_start(tmp_path: Path, verb: str, seed: int) -> None:
    words, ready, lines = VERBS[verb]
    last = Random(f"{verb} {seed}").randrange(FIRST, lines)
    with command(tmp_path, words(tmp_path)) as running:
        for number, line in zip(count(), running.lines(), strict=False):
            if number == last or ready in line:
                break
        running.send(signal.SIGINT)
        running.require_quiet(0, INTERRUPTED)
