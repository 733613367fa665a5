"""LinuxCNC's code, judged by LinuxCNC's own interpreter."""

from collections.abc import Callable, Iterable
from math import inf

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from stepnc_model.errors import PostError
from stepnc_model.nc.exact_reading import read, read_blocks
from stepnc_model.post.blocks import (
    Block,
    Comment,
    Cycles,
    MachineType,
    PathControl,
    ProgramEnd,
    ProgramStart,
    Rapid,
)
from stepnc_model.post.canonical import Canonical, commands
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.dialects import write
from tests.stepnc_model.post.trace import difference

Interpreter = Callable[[Iterable[str]], tuple[Canonical, ...]]
PROGRAMS = ["milled", "drilled", "tapped", "turned"]


@pytest.mark.parametrize("cycles", Cycles)
@pytest.mark.parametrize("name", PROGRAMS)
def test_linuxcnc_reads_what_we_mean(
    name: str, cycles: Cycles, interpreter: Interpreter, request: pytest.FixtureRequest
) -> None:
    blocks: list[Block] = request.getfixturevalue(name)
    judged = interpreter(write(blocks, Dialect.LINUXCNC, cycles=cycles))
    assert difference(commands(blocks), judged) == ""


@pytest.mark.parametrize("cycles", Cycles)
@pytest.mark.parametrize("name", PROGRAMS)
def test_our_reader_reads_what_linuxcnc_reads(
    name: str, cycles: Cycles, interpreter: Interpreter, request: pytest.FixtureRequest
) -> None:
    lines = list(write(request.getfixturevalue(name), Dialect.LINUXCNC, cycles=cycles))
    assert difference(read(lines, Dialect.LINUXCNC), interpreter(lines)) == ""


@settings(
    max_examples=120,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(data=st.data())
def test_whatever_moves_linuxcnc_runs_it(
    interpreter: Interpreter, moving: st.SearchStrategy[list[Block]], data: st.DataObject
) -> None:
    """No arc is refused, and none becomes another one."""
    blocks = data.draw(moving)
    lines = list(write(blocks, Dialect.LINUXCNC))
    judged = interpreter(lines)
    assert difference(commands(blocks), judged) == ""
    assert difference(read(lines, Dialect.LINUXCNC), judged) == ""


@pytest.mark.parametrize(
    "text", ["MSG, hello", "debug,x", "PROBEOPEN x", " print, #1", "(x)", "AXIS,hide"]
)
def test_a_comment_does_nothing(text: str, interpreter: Interpreter) -> None:
    blocks: list[Block] = [ProgramStart(name="C"), Comment(text=text), ProgramEnd()]
    names = [command.name for command in interpreter(write(blocks, Dialect.LINUXCNC))]
    assert "MESSAGE" not in names
    assert names.count("COMMENT") >= 2


def test_a_lathe_writes_diameters(turned: list[Block]) -> None:
    lines = list(write(turned, Dialect.LINUXCNC))
    assert lines[2].split()[1:] == [
        "G18",
        "G21",
        "G40",
        "G49",
        "G54",
        "G7",
        "G80",
        "G90",
        "G91.1",
        "G94",
        "G97",
    ]
    assert "N80 G95 G1 X60 Z0 F0.2" in lines
    assert "N100 G94 G1 X81 Z-20 F300" in lines


def test_the_lead_of_a_taper_is_measured_along_it(turned: list[Block]) -> None:
    """2 mm along z; 1 mm of radius on 22 mm: 2·√(1 + 1/22²) = 2.0021 mm."""
    lines = list(write(turned, Dialect.LINUXCNC))
    assert any(line.endswith("G33 X32 Z-20 K2.0021") for line in lines)


def test_a_lathe_has_no_y() -> None:
    blocks: list[Block] = [
        ProgramStart(name="L", machine=MachineType.LATHE),
        Rapid(end=(1.0, 2.0, 3.0)),
    ]
    with pytest.raises(PostError, match="y = 2 mm: a lathe has no y"):
        list(write(blocks, Dialect.LINUXCNC))


@pytest.mark.parametrize(
    ("words", "control"),
    [
        ("G64 P0.02", PathControl(tolerance=0.02)),
        ("G64 P0.02 Q0.01", PathControl(tolerance=0.02, joining=0.01)),
        ("G64", PathControl(tolerance=inf)),
        ("G61", PathControl(tolerance=0.0)),
        ("G61.1", PathControl(tolerance=0.0, is_exact_stop=True)),
    ],
)
def test_path_control_is_read_and_written_back(words: str, control: PathControl) -> None:
    (found,) = read_blocks([words], Dialect.LINUXCNC)
    assert found == control
    assert list(write([found], Dialect.LINUXCNC)) == [f"N10 {words}"]
