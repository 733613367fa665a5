"""Every control: what is written is read back as what was meant."""

from collections.abc import Iterable

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from stepnc_model.errors import PostError
from stepnc_model.nc.exact_reading import read, read_blocks
from stepnc_model.post.blocks import (
    Block,
    Coolant,
    CoolantKind,
    Cycles,
    Linear,
    MachineType,
    Pause,
    ProgramStart,
    Rapid,
    Rate,
)
from stepnc_model.post.canonical import commands
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.dialects import write
from tests.every_case import every_case
from tests.stepnc_model.post.trace import difference

DIALECTS = [control for control in Dialect if control is not Dialect.CANONICAL]
ROUNDED_SPEED = 0.5
"""rpm: Fanuc and Haas write whole S words"""

SPLIT = 2.5e-3
"""mm: controls without several turns round where each of them ends"""


def lines_of(
    blocks: Iterable[Block], control: Dialect, cycles: Cycles = Cycles.EXPANDED
) -> list[str]:
    return list(write(blocks, control, cycles=cycles))


TOLD = [
    (name, control)
    for name in ("milled", "drilled", "tapped", "turned")
    for control in Dialect
    if (name, control) != ("turned", Dialect.HEIDENHAIN)
]
"""Klartext is for mills: another test says that a lathe is refused"""


@pytest.mark.parametrize("cycles", Cycles)
@pytest.mark.parametrize(("name", "control"), TOLD)
def test_what_is_written_is_read_back(
    name: str, control: Dialect, cycles: Cycles, request: pytest.FixtureRequest
) -> None:
    blocks: list[Block] = request.getfixturevalue(name)
    if control is Dialect.HEIDENHAIN:
        flood = Coolant(kinds=frozenset({CoolantKind.FLOOD}))
        blocks = [flood if isinstance(b, Coolant) and b.kinds else b for b in blocks]
    machine = MachineType.LATHE if name == "turned" else MachineType.MILL
    back = read(lines_of(blocks, control, cycles), control, machine=machine)
    assert difference(commands(blocks), back, length=SPLIT, speed=ROUNDED_SPEED) == ""


@pytest.mark.parametrize("control", DIALECTS)
@settings(
    max_examples=80,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(data=st.data())
def test_whatever_moves_is_read_back(
    control: Dialect, moving: st.SearchStrategy[list[Block]], data: st.DataObject
) -> None:
    """Against the canonical commands on the grid of the control."""
    blocks = data.draw(moving)
    places = 4 if control is Dialect.LINUXCNC else 3
    back = read(lines_of(blocks, control), control)
    meant = commands(blocks, places=places)
    assert difference(meant, back, length=SPLIT, speed=1e-3) == ""


@pytest.mark.parametrize("control", DIALECTS)
def test_code_of_one_control_becomes_code_of_another(
    control: Dialect, drilled: list[Block]
) -> None:
    blocks = list(read_blocks(lines_of(drilled, control, Cycles.OWN), control))
    again = read(lines_of([drilled[0], *blocks], Dialect.FANUC), Dialect.FANUC)
    assert difference(commands(drilled), again) == ""


def test_canonical_commands_have_no_blocks() -> None:
    with pytest.raises(PostError, match="canonical commands are no NC code"):
        list(read_blocks([], Dialect.CANONICAL))


@pytest.mark.parametrize("control", DIALECTS)
def test_writing_starts_before_the_program_is_complete(control: Dialect) -> None:
    """A program is never held as a whole: what follows is not asked for ahead."""

    def endless() -> Iterable[Block]:
        yield ProgramStart(name="LONG")
        yield Rapid(end=(0.0, 0.0, 0.0))
        x = 0.0
        while True:
            x += 1.0
            yield Linear(end=(x, 0.0, 0.0), rate=Rate(value=1.0))

    lines = write(endless(), control)
    assert len([next(lines) for _ in range(1000)]) == 1000


@every_case("control", DIALECTS)
def test_a_feed_below_the_last_digit_is_refused(control: Dialect) -> None:
    blocks: list[Block] = [
        ProgramStart(name="F"),
        Linear(end=(1.0, 0.0, 0.0), rate=Rate(value=1e-9)),
    ]
    with pytest.raises(PostError, match="too small for an F word"):
        lines_of(blocks, control)


@every_case("control", Dialect)
def test_files_have_an_ending(control: Dialect) -> None:
    assert control.suffix.startswith(".")


@every_case("control", Dialect)
def test_what_is_no_code_is_refused_with_its_line(control: Dialect) -> None:
    good = lines_of([ProgramStart(name="X"), Pause(seconds=1.0)], control)
    with pytest.raises(PostError, match=f"line {len(good) + 1}: ") as caught:
        read([*good, "!?"], control)
    assert caught.value.line == len(good) + 1
