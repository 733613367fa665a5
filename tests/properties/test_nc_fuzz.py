"""Damaged NC code is read as what it says, or refused with its line; nothing else comes out."""

import random
import re
from functools import cache
from math import isfinite
from pathlib import Path

import pytest

from stepnc_model.errors import PostError
from stepnc_model.nc.exact_reading import read
from stepnc_model.post.blocks import Cycles, MachineType
from stepnc_model.post.canonical import Canonical
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.dialects import write
from stepnc_model.post.neutral import blocks_of
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.generate import generate
from tests.every_case import every_case

PARTS = Path(__file__).parents[2] / "examples" / "parts"
PROGRAMS = [(MachineType.MILL, control, cycles) for control in Dialect for cycles in Cycles] + [
    (MachineType.LATHE, control, Cycles.EXPANDED)
    for control in Dialect
    if control is not Dialect.HEIDENHAIN
]

CHARACTERS = "XYZFSGMTNRIJKPQHLABCODE0123456789.-+()%;=,\"'#[]* \t<>/$\\\x00é²٣~\u2028"
"""what is typed where it does not belong"""

NUMBERS = ("0", "-1", "9" * 400, "-" + "9" * 30, "1.5", "00", "1E5", "nan", "inf", "٣")

RUNS = 120
"""of each program"""

QUIET = {"COMMENT", "MESSAGE"}


@cache
def code_of(machine: MachineType, control: Dialect, cycles: Cycles) -> tuple[str, ...]:
    """NC code of an example: each kind of line a few times, so that it is short."""
    name = "bracket" if machine is MachineType.MILL else "shaft"
    program = Program.load(PARTS / f"{name}.stpnc")
    blocks = blocks_of(program, list(generate(program)), name="P")
    lines = list(write(blocks, control, cycles=cycles))
    return tuple(lines[:150] + lines[-60:])


def damaged(code: tuple[str, ...], chance: random.Random) -> list[str]:
    """Code with one to five faults."""
    lines = list(code)
    for _ in range(chance.choice((1, 1, 2, 5))):
        at = chance.randrange(len(lines))
        line = lines[at]
        place = chance.randrange(len(line) + 1)
        kind = chance.randrange(6)
        numbers = list(re.finditer(r"-?[0-9]+\.?[0-9]*", line))
        if kind == 0:
            lines[at] = line[:place] + line[place + 1 :]
        elif kind == 1:
            lines[at] = line[:place] + chance.choice(CHARACTERS) + line[place:]
        elif kind == 2:
            lines[at] = line[:place] + line[max(0, place - 1) :]
        elif kind == 3:
            lines.insert(at, chance.choice(lines))
        elif kind == 4:
            lines[at], lines[0] = lines[0], line
        elif numbers:
            found = chance.choice(numbers)
            lines[at] = line[: found.start()] + chance.choice(NUMBERS) + line[found.end() :]
    return lines


def require_finite(commands: tuple[Canonical, ...]) -> None:
    """Every number of a command that moves or sets something."""
    for command in commands:
        numbers = [each for each in command.arguments if isinstance(each, (int, float))]
        assert command.name in QUIET or all(map(isfinite, numbers))


@pytest.mark.parametrize(("machine", "control", "cycles"), PROGRAMS)
def test_damaged_code_is_read_or_refused_with_its_line(
    machine: MachineType, control: Dialect, cycles: Cycles
) -> None:
    code = code_of(machine, control, cycles)
    for seed in range(RUNS):
        lines = damaged(code, random.Random(seed))
        refusal = PostError("", line=1)
        try:
            require_finite(read(lines, control, machine=machine))
        except PostError as error:
            refusal = error
        assert refusal.line > 0, seed
        assert len(str(refusal)) < 300, seed


@pytest.mark.parametrize(("machine", "control", "cycles"), PROGRAMS)
def test_a_word_that_no_control_knows_is_never_skipped(
    machine: MachineType, control: Dialect, cycles: Cycles
) -> None:
    code = code_of(machine, control, cycles)
    # What stands behind the end of a program is not read.
    no_words = re.compile(r"[;(%]|END PGM")
    bare = [at for at, line in enumerate(code) if line and not no_words.search(line)]
    for seed in range(RUNS):
        at = random.Random(seed).choice(bare or [1])
        if "~" in code[at]:
            continue
        lines = [*code[:at], f"{code[at]} ?7", *code[at + 1 :]]
        with pytest.raises(PostError):
            read(lines, control, machine=machine)


@every_case(
    ("control", "lines", "words"),
    [
        (Dialect.LINUXCNC, ["O100 CALL"], "the subprogram 100 is not in this file"),
        (Dialect.FANUC, ["M3 M4 S100"], "two commands of the spindle"),
        (Dialect.FANUC, ["G17 G18"], "two planes"),
        (Dialect.FANUC, ["G0 X" + "9" * 400], "is no word"),
        (Dialect.FANUC, ["G1 X5 F-100"], "no feed in force"),
        (Dialect.LINUXCNC, ["G33 K1"], "K: not used"),
        (Dialect.LINUXCNC, ["G33 Z-5 K0"], "a thread whose lead is not known"),
        (Dialect.LINUXCNC, ["F60 G83 X0 Y0 Z-1000 R1 Q0.0001"], "at most 10000"),
        (Dialect.SINUMERIK, ["SPOS=90"], "angles other than 0"),
        (
            Dialect.HEIDENHAIN,
            ["0 TOOL CALL " + "9" * 5000 + " Z S100"],
            "a number of 1e+09 or more",
        ),
        (Dialect.HEIDENHAIN, ["0 CC X+1 FMAX"], "CC needs two"),
        (Dialect.HEIDENHAIN, ["0 L X+ FMAX"], "'+' is not"),
        (
            Dialect.HEIDENHAIN,
            ["0 CYCL DEF 200 DRILLING Q200=+0 what?"],
            "Q200=nan is not read",
        ),
        (Dialect.HEIDENHAIN, ["0 CYCL DEF 200 DRILLING Q210=+5"], "Q210=5 is not read"),
        (Dialect.CANONICAL, ["1 STRAIGHT_FEED(1E999, 0, 0)"], "must be numbers"),
        (Dialect.CANONICAL, ["1 ARC_FEED(1, 1, 0, 0, 1.5, 0)"], "whole number"),
    ],
)
def test_what_is_no_code_is_refused_with_what_is_wrong(
    control: Dialect, lines: list[str], words: str
) -> None:
    with pytest.raises(PostError, match=re.escape(words)) as caught:
        read(lines, control)
    assert caught.value.line == 1
