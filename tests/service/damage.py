"""Damaged files of one kind: instances left out, bytes flipped, ends cut off; and commands."""

import io
from collections.abc import Sequence
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from random import Random

import stepnc
from service.cli.main import main
from stepnc_model.part21.reader import Part21File

PARTS = Path(__file__).parents[2] / "examples" / "parts"

EXPECTED = {0, 3, 4, 5, 6}
"""Exit codes with which a command ends that reads a file."""

PROGRAM_COMMANDS = (
    ("check",),
    ("toolpath",),
    ("post", "--control", "linuxcnc", "-o", "OUT"),
    ("convert", "--to", "ap238", "-o", "OUT"),
    ("convert", "--profile", "standard", "-o", "OUT"),
    ("cycletime", "--machine", "vmc15"),
    ("simulate", "--machine", "vmc15", "--material", "c45"),
    ("optimise", "--machine", "vmc15", "--material", "c45", "--dry-run"),
)
"""Commands that read a STEP-NC program, which follows their name."""


def run(arguments: Sequence[str]) -> tuple[object, str]:
    """Run a command in this process; its exit code and what it told.

    Whatever is raised instead of an exit is the fault that tests look for, and passes.
    """
    out, told = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(told):
        try:
            main(arguments)
        except SystemExit as stopped:
            return stopped.code, told.getvalue()
    return None, told.getvalue()


def without_each(data: bytes) -> dict[int, bytes]:
    """A program without each of its instances, by the number of the instance."""
    file = Part21File.from_bytes(data)
    found = {}
    for id in file.ids():
        start, end = file.span(id)
        found[id] = data[:start] + data[end:]
    return found


def programs(folder: Path) -> dict[str, bytes]:
    """Sample programs, and one of them in AP238."""
    aim = folder / "ap238.stpnc"
    stepnc.convert(PARTS / "paper002.stpnc", to="ap238", output=aim)
    samples = {path.name: path.read_bytes() for path in sorted(PARTS.glob("*.stpnc"))}
    return samples | {aim.name: aim.read_bytes()}


def failures(
    path: Path, data: bytes, commands: Sequence[Sequence[str]], what: str
) -> list[str]:
    """What went wrong where commands read a damaged program."""
    path.write_bytes(data)
    out = path.with_suffix(".out")
    wrong = []
    for name, *rest in commands:
        options = [str(out) if each == "OUT" else each for each in rest]
        try:
            code, told = run([name, str(path), *options])
        except Exception as error:
            wrong.append(f"{what}: {name}: {type(error).__name__}: {error}")
            continue
        if code not in EXPECTED or "Traceback" in told:
            wrong.append(f"{what}: {name}: exit {code}: {told[-300:]}")
    return wrong


def damaged(data: bytes, rng: Random) -> bytes:
    """Data cut off, or with a byte of a class replaced by one of the same or another class."""
    if not data:
        return data
    if rng.random() < 0.3:
        return data[: rng.randrange(len(data))]
    classes = (
        b"0123456789",
        b"abcXYZ_",
        b" \t\r\n",
        b"(),;='#$*./\"",
        b"\x00\x7f",
        b"\x80\xff",
    )
    at = rng.randrange(len(data))
    return data[:at] + bytes([rng.choice(rng.choice(classes))]) + data[at + 1 :]
