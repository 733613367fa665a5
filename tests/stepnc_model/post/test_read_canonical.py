"""Canonical commands from text: ours, NIST's, LinuxCNC's."""

from collections import Counter
from pathlib import Path

import pytest

from stepnc_model.errors import PostError
from stepnc_model.post.blocks import Block
from stepnc_model.post.canonical import Canonical, commands, read, write
from tests.every_case import every_case
from tests.stepnc_model.post.trace import difference, trace

NIST = Path(__file__).parents[4] / "shared" / "corpus" / "iso14649" / "ex1.canonical.txt"


@pytest.mark.skipif(not NIST.is_file(), reason="no corpus beside the project")
def test_the_file_of_nist_is_read() -> None:
    found = list(read(NIST.read_text().splitlines()))
    counts = Counter(command.name for command in found)
    assert len(found) == 538
    assert (counts["ARC_FEED"], counts["PROGRAM_END"]) == (100, 1)
    assert found[13] == Canonical("STRAIGHT_TRAVERSE", (91.9, -13.5, 200.0))
    assert found[88] == Canonical("ARC_FEED", (77.2, 55.0, 70.0, 55.0, -3, -5.9))
    assert trace(found)[-1].kind == "program_end"


@pytest.mark.parametrize("name", ["milled", "drilled", "tapped", "turned"])
def test_what_we_write_is_read_back(name: str, request: pytest.FixtureRequest) -> None:
    blocks: list[Block] = request.getfixturevalue(name)
    assert difference(commands(blocks), read(write(blocks)), length=1e-4, speed=1e-4) == ""


@every_case(
    ("line", "command"),
    [
        (
            "   27 N..... STRAIGHT_FEED(1.0000, 2.0000, 3.0000, 0.0000, 0.0000, 0.0000)",
            Canonical("STRAIGHT_FEED", (1.0, 2.0, 3.0)),
        ),
        (
            "   24 N..... SET_SPINDLE_SPEED(0, 1000.0000)",
            Canonical("SET_SPINDLE_SPEED", (1e3,)),
        ),
        ("   49 N..... SET_SPINDLE_MODE(0 3000.0000)", Canonical("SET_SPINDLE_MODE", (3e3,))),
        ("    8 N..... START_SPINDLE_CLOCKWISE(0)", Canonical("START_SPINDLE_CLOCKWISE")),
        ("   13 START_SPINDLE_CLOCKWISE()", Canonical("START_SPINDLE_CLOCKWISE")),
        ('    7 N..... COMMENT("hello, (you)")', Canonical("COMMENT", ("hello, (you)",))),
    ],
)
def test_layouts_of_nist_and_linuxcnc_mean_the_same(line: str, command: Canonical) -> None:
    assert list(read([line, ""])) == [command]


@every_case(
    ("line", "message"),
    [
        ("FLY_TO(1, 2, 3)", "is not a canonical command"),
        ("G1 X0", "is not a canonical command"),
        ("STRAIGHT_FEED(1, 2)", "2 arguments: it needs 3"),
        ("ARC_FEED(1, 2, 3, 4, 1)", "5 arguments: it needs 6"),
        ("DWELL(soon)", "must be numbers"),
    ],
)
def test_anything_else_is_refused(line: str, message: str) -> None:
    with pytest.raises(PostError, match=message) as caught:
        list(read(["PROGRAM_STOP()", line]))
    assert caught.value.line == 2
