"""Foreign programs, read and rewritten, are what LinuxCNC's interpreter executes."""

import random
from math import atan2, copysign, hypot, isnan, pi
from pathlib import Path

import numpy as np
import pytest

from stepnc_model.nc.advice import BlockAdvice
from stepnc_model.nc.moves import MoveFlag, MoveKind
from stepnc_model.nc.number_style import style_of
from stepnc_model.nc.program import NcProgram, read_program
from stepnc_model.nc.rewrite import rewrite
from stepnc_model.post.dialect import Dialect
from tests.stepnc_model.nc.conftest import CanonicalMove, Oracle

WHOLE = [
    "3dtest.ngc",
    "arcspiral.ngc",
    "b-index.ngc",
    "cds.ngc",
    "lathe_pawn.ngc",
    "skeleton.ngc",
    "tort.ngc",
]
"""samples that are understood from end to end"""

PARTLY = ["3D_Chips.ngc", "daisy.ngc", "comp.ngc", "comp311.ngc", "comp-g1.ngc"]
"""samples with variables, conditions and compensation"""

NAMES = {
    MoveKind.RAPID: "STRAIGHT_TRAVERSE",
    MoveKind.LINE: "STRAIGHT_FEED",
    MoveKind.ARC: "ARC_FEED",
}
DIGIT = 1e-4
"""mm: what canonical commands print, in mm"""

INCH_DIGIT = 2.6e-3


def read(path: Path) -> NcProgram:
    return read_program(path.read_bytes(), dialect=Dialect.LINUXCNC)


def digit(program: NcProgram) -> float:
    """Last digit of a canonical command, mm; 25.4 times as much in inches."""
    return INCH_DIGIT if program.unit > 1.0 else DIGIT


def advice_for(program: NcProgram, seed: int) -> list[BlockAdvice]:
    """Random feeds along every second block that may change."""
    chance = random.Random(seed)
    moves = program.moves
    advice = []
    for block in np.unique(moves.block[moves.is_advisable]):
        if chance.random() < 0.5:
            continue
        cuts = sorted({
            round(chance.uniform(0.05, 0.95), 3) for _ in range(chance.randrange(4))
        })
        ends = (*cuts, 1.0)
        feeds = tuple(chance.uniform(1.0, 40.0) for _ in ends)
        advice.append(BlockAdvice(block=int(block), ends=ends, feeds=feeds))
    return advice


@pytest.mark.parametrize("name", WHOLE)
def test_a_sample_is_executed_as_by_linuxcnc(
    name: str, samples: Path, linuxcnc: Oracle
) -> None:
    program = read(samples / name)
    moves, truth = program.moves, linuxcnc((samples / name).read_bytes())
    mine = [index for index in range(len(moves)) if moves.kind[index] in NAMES]
    assert len(mine) == len(truth)
    for index, true in zip(mine, truth, strict=True):
        move = moves.move(index)
        assert NAMES[move.kind] == true.name
        for value, wanted in zip(move.end, true.end, strict=True):
            assert isnan(value) or value == pytest.approx(wanted, abs=digit(program))
        if not isnan(move.feed):
            assert move.feed * 60.0 == pytest.approx(true.feed, rel=1e-3)
        if move.arc is not None and true.centre is not None:
            centre = [move.arc.centre[axis] for axis in true.axes[:2]]
            assert centre == pytest.approx(true.centre, abs=2.0 * digit(program))


@pytest.mark.parametrize("name", WHOLE + PARTLY)
@pytest.mark.parametrize("seed", [1, 2])
def test_only_feeds_change_and_pieces_end_on_the_path(
    name: str, seed: int, samples: Path, linuxcnc: Oracle
) -> None:
    program = read(samples / name)
    result = rewrite(program, advice_for(program, seed))
    before, after = linuxcnc(program.text.data), linuxcnc(result.data)
    step = style_of(program.text, program.dialect, unit=program.unit).places
    allowed = program.unit * 0.5 * 10.0**-step + digit(program)
    place = 0
    at = (0.0, 0.0, 0.0)
    pieces = 0
    for old in before:
        start, count = at, 0
        while True:
            new = after[place]
            assert new.name == old.name
            place, count = place + 1, count + 1
            if new.end == old.end:
                break
            assert off_path(start, old, new.end) <= allowed * 3.0
            assert new.rotation == 0 or (new.rotation > 0) is (old.rotation > 0)
            at = new.end
        pieces += count - 1
        at = old.end
    assert place == len(after)
    assert pieces == result.added


HELICES = (
    b"G21 G90 G17\nG0 X60 Y40 Z1\nG3 I-10 J0 Z-6 P3 F300\nG2 X40 Y40 I-10 J0 Z-8 P2\n"
    b"G18\nG0 X0 Y0 Z0\nG2 X10 Z10 Y-3 I10 K0 P4\nG91 G17\nG3 X5 Y5 I5 J0 P2\nM2\n"
)


def turn_of(start: tuple[float, float, float], move: CanonicalMove) -> float:
    """Angle of an arc as LinuxCNC executes it, in turns."""
    assert move.centre is not None
    first, second = move.axes[:2]
    u, v = move.centre
    begin = atan2(start[second] - v, start[first] - u)
    end = atan2(move.end[second] - v, move.end[first] - u)
    part = (copysign(1.0, move.rotation) * (end - begin) / (2.0 * pi)) % 1.0
    return copysign(part + abs(move.rotation) - 1.0 + (part < 1e-6), move.rotation)


@pytest.mark.parametrize("seed", range(6))
def test_arcs_of_many_turns_are_divided_into_as_many_turns(seed: int, linuxcnc: Oracle) -> None:
    program = read_program(HELICES, dialect=Dialect.LINUXCNC)
    result = rewrite(program, advice_for(program, seed))
    before, after = linuxcnc(HELICES), linuxcnc(result.data)
    at, place = (0.0, 0.0, 0.0), 0
    for old in before:
        turns, start = 0.0, at
        while True:
            new, place = after[place], place + 1
            if new.centre is not None:
                assert new.centre == pytest.approx(old.centre, abs=1e-3)
                turns += turn_of(start, new)
            start = new.end
            if new.end == pytest.approx(old.end, abs=1e-6) and (
                old.centre is None or abs(turns) > abs(turn_of(at, old)) - 0.5
            ):
                break
        if old.centre is not None:
            assert turns == pytest.approx(turn_of(at, old), abs=1e-4)
        at = old.end
    assert place == len(after)
    assert len(after) == len(before) + result.added


def off_path(
    start: tuple[float, float, float], move: CanonicalMove, point: tuple[float, float, float]
) -> float:
    """Distance of a point from the line or circle of a move, mm."""
    if move.centre is None:
        a, b, p = (np.array(each) for each in (start, move.end, point))
        length = float(np.linalg.norm(b - a))
        return float(np.linalg.norm(np.cross(b - a, p - a)) / length) if length else 0.0
    first, second, _ = move.axes
    radii = [
        hypot(each[first] - move.centre[0], each[second] - move.centre[1])
        for each in (start, move.end, point)
    ]
    return max(0.0, radii[2] - max(radii[:2]), min(radii[:2]) - radii[2])


def test_moves_with_variables_or_compensation_are_not_split(samples: Path) -> None:
    for name in PARTLY:
        moves = read(samples / name).moves
        held = int(MoveFlag.COMPENSATED | MoveFlag.MACRO)
        assert not (moves.is_splittable & ((moves.flags & held) != 0)).any()
