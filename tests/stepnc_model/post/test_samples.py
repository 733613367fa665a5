"""The sample parts, from the file to the control and back."""

from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path

import pytest

from stepnc_model.nc.exact_reading import read
from stepnc_model.post.blocks import Block, ProgramStart
from stepnc_model.post.canonical import Canonical, commands
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.dialects import write
from stepnc_model.post.neutral import blocks_of
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.generate import generate
from tests.stepnc_model.post.trace import difference

PARTS = Path(__file__).parents[3] / "examples" / "parts"
CORPUS = Path(__file__).parents[4] / "shared" / "corpus" / "iso14649"
FILES = [
    PARTS / "bracket.stpnc",
    PARTS / "shaft.stpnc",
    CORPUS / "ex1.stp",
    CORPUS / "ex1E.stp",
]

Interpreter = Callable[[Iterable[str]], tuple[Canonical, ...]]


@cache
def posted(path: Path) -> tuple[Block, ...]:
    if not path.is_file():
        pytest.skip(f"no {path.name} beside the project")
    program = Program.load(path)
    return tuple(blocks_of(program, list(generate(program)), name=path.stem))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_linuxcnc_runs_every_sample_as_meant(path: Path, interpreter: Interpreter) -> None:
    blocks = posted(path)
    assert difference(commands(blocks), interpreter(write(blocks, Dialect.LINUXCNC))) == ""


TOLD = [
    pytest.param(path, control, id=f"{path.stem}-{control}")
    for path in FILES
    for control in Dialect
    if (path.stem, control) != ("shaft", Dialect.HEIDENHAIN)
]
"""Klartext is for mills: another test says that a lathe is refused"""


@pytest.mark.parametrize(("path", "control"), TOLD)
def test_every_control_is_told_the_same(path: Path, control: Dialect) -> None:
    """To the last digit of three, and to whole S words of Fanuc and Haas."""
    blocks = posted(path)
    assert isinstance(blocks[0], ProgramStart)
    lines = [line for text in write(blocks, control) for line in text.split("\n")]
    back = read(lines, control, machine=blocks[0].machine)
    places = 4 if control in {Dialect.CANONICAL, Dialect.LINUXCNC} else 3
    meant = commands(blocks, places=places)
    assert difference(meant, back, length=1e-3, speed=0.5) == ""
