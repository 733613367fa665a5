"""Ctrl-C and SIGTERM end a command quietly, at any moment."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from service.cli import commands
from service.cli.interrupts import INTERRUPTED, SIGNALS
from service.cli.main import main
from tests.extras.factory.shops import program_file
from tests.service.cli.command import command
from tests.service.waiting import LONG, ROOT

WORK = """
import atexit, os, signal, sys, threading
from contextlib import suppress
from service.cli import commands, main

def ask(number=signal.SIGINT):
    os.kill(os.getpid(), number)

def go_on():
    threading.Event().wait()

class Lost:
    def __del__(self):
        ask()

commands.parsed = lambda *_: work
{}
main.main()
"""
"""A process of a command whose work asks itself to end."""

LATER = """
def leave():
    for _ in range({}): ask()
    sys.stderr.write("left\\n")
def work():
    atexit.register(leave)
    return 5
"""

INSIDE = """
def work():
    try: ask(); go_on()
    finally:
        ask(signal.SIGTERM)
        sys.stderr.write("clean, ")
"""

AGAIN = """
def work():
    for _ in range(2):
        with suppress(KeyboardInterrupt): ask()
    ask(); go_on()
"""

REPLACED = """
def work():
    with suppress(KeyboardInterrupt): ask()
    raise RuntimeError
"""

WORKS = {
    "SIGINT": ("def work(): ask(); go_on()", INTERRUPTED, "interrupted\n"),
    "SIGTERM": ("def work(): ask(signal.SIGTERM); go_on()", INTERRUPTED, "interrupted\n"),
    "early": ("commands.parsed = lambda *_: ask() or go_on", INTERRUPTED, "interrupted\n"),
    "lost in a destructor": ("def work(): Lost(); go_on()", INTERRUPTED, "interrupted\n"),
    "while it cleans up": (INSIDE, INTERRUPTED, "clean, interrupted\n"),
    "a third time": (AGAIN, INTERRUPTED, "interrupted\n"),
    "replaced by a compiler": (REPLACED, INTERRUPTED, "interrupted\n"),
    "late": (LATER.format(2), 5, "left\n"),
    "late, a third time": (LATER.format(3), INTERRUPTED, ""),
}
"""Work, exit code and stderr."""


@pytest.mark.parametrize("name", WORKS)
def test_an_interrupt_ends_a_command_quietly(name: str) -> None:
    work, code, said = WORKS[name]
    answer = subprocess.run(
        [sys.executable, "-c", WORK.format(work)],
        capture_output=True, text=True, timeout=LONG, check=False, cwd=ROOT,
    )  # fmt: skip
    assert (answer.returncode, answer.stderr) == (code, said)


def test_another_failure_stays_what_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(commands, "parsed", lambda *_: lambda: 1 // 0)
    before = {number: signal.getsignal(number) for number in SIGNALS}
    with pytest.raises(ZeroDivisionError):
        main(["machines"])
    assert {number: signal.getsignal(number) for number in SIGNALS} == before


@pytest.mark.parametrize("number", SIGNALS)
def test_while_its_modules_are_loaded(tmp_path: Path, number: int) -> None:
    with command(tmp_path, ["machines"]) as machines:
        machines.wait_for("service.cli.commands")
        machines.send(number)
        machines.require_quiet(INTERRUPTED)
    assert machines.said == "interrupted\n"


@pytest.mark.parametrize("moment", ["extras.factory.requests", "numpy"])
def test_while_a_live_shop_starts(tmp_path: Path, moment: str) -> None:
    words = ["factory", str(program_file(tmp_path)), "--live", "--port", "0"]
    with command(tmp_path, words) as shop:
        shop.wait_for(moment)
        shop.send(signal.SIGINT)
        shop.require_quiet(INTERRUPTED)
