"""Lines of a rewritten program and where they come from."""

import pytest

from stepnc_model.nc.advice import BlockAdvice
from stepnc_model.nc.moves import MoveKind
from stepnc_model.nc.program import read_program
from stepnc_model.nc.rewrite import rewrite
from stepnc_model.nc.written_lines import LineOrigin, WrittenLines, line_ends
from stepnc_model.post.dialect import Dialect

CODE = b"G21 G90\nT1 M6\nS900 M3\nG0 X0 Y0 Z5\nG1 Z-1 F100\nX10 F200\n/Y10\nX0\nY0\n"


def test_lines_behind_divided_blocks_come_from_their_own_line() -> None:
    lines = WrittenLines()
    lines.divide(3, [1.0, 3.0])
    lines.put_before(4)
    lines.divide(9, [2.0, 2.0, 4.0])
    assert lines.added == 4
    assert lines.origin(2) == LineOrigin(line=2, begin=0.0, end=1.0)
    assert lines.origin(3) == LineOrigin(line=3, begin=0.0, end=0.25)
    assert lines.origin(4) == LineOrigin(line=3, begin=0.25, end=1.0)
    assert lines.origin(6) == LineOrigin(line=4, begin=0.0, end=1.0)
    assert [lines.origin(line).line for line in (7, 10, 11, 12, 13, 14)] == [5, 8, 9, 9, 9, 10]
    assert lines.origin(12) == LineOrigin(line=9, begin=0.25, end=0.5)


def test_rewritten_blocks_come_from_the_blocks_with_their_moves() -> None:
    """Each rewritten move ends on its part of the move that it comes from."""
    program = read_program(CODE, dialect=Dialect.LINUXCNC)
    advice = [
        BlockAdvice(block=5, ends=(0.25, 0.75, 1.0), feeds=(5.0, 9.0, 7.0)),
        BlockAdvice(block=8, ends=(0.5, 1.0), feeds=(5.0, 6.0)),
    ]
    result = rewrite(program, advice)
    again = read_program(result.data, dialect=Dialect.LINUXCNC)
    by_line = {program.text.line(each.block): each for each in program.moves.each()}
    count = 0
    for move in again.moves.each():
        count += 1
        if move.kind is MoveKind.RAPID:
            continue
        origin = result.lines.origin(again.text.line(move.block))
        old = by_line[origin.line]
        for axis in range(3):
            way = old.end[axis] - old.start[axis]
            assert move.end[axis] == pytest.approx(old.start[axis] + origin.end * way)
            assert move.start[axis] == pytest.approx(old.start[axis] + origin.begin * way)
    assert count == len(program.moves) + result.added == len(by_line) + 3
    assert result.data.count(b"\n") == CODE.count(b"\n") + result.lines.added
    assert result.restored == 1


@pytest.mark.parametrize(("text", "count"), [("a\r\nb\n", 2), ("a\rb", 1), ("", 0)])
def test_line_ends_are_those_of_all_systems(text: str, count: int) -> None:
    assert line_ends(text) == count
