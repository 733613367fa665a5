"""Curves written from moves: reading them gives the moves back."""

from math import atan2, cos, hypot, pi, sin

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stepnc_model.editing.draft import Draft
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.arc import length
from stepnc_model.toolpath.curve import CHORD_TOLERANCE, Segment, move_of, segments_of
from stepnc_model.toolpath.explicit.curve_writer import CurveWriter, HelixForm, WrittenCurve
from stepnc_model.toolpath.frame import Frame
from stepnc_model.toolpath.path import Arc, ArcPlane, Move, MoveType, Point

EMPTY = (
    b"ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('MACHINING_SCHEMA'));\nENDSEC;\nDATA;\n"
    b"#1=PROJECT('P',#2,(),$,$,$);\n#2=WORKPLAN('W',(),$,$,$);\n"
    b"ENDSEC;\nEND-ISO-10303-21;\n"
)
FRAMES = (
    Frame(),
    Frame(origin=(100.0, -3.0, 10.0), x=(0.0, 1.0, 0.0), y=(-1.0, 0.0, 0.0)),
    Frame(origin=(1.0, 2.0, 3.0), x=(0.6, 0.8, 0.0), y=(-0.8, 0.6, 0.0)),
    Frame(x=(1.0, 0.0, 0.0), y=(0.0, 0.0, 1.0), z=(0.0, -1.0, 0.0)),
)
COORDINATES = st.floats(-50.0, 50.0).map(lambda value: round(value, 3))
POINTS = st.tuples(COORDINATES, COORDINATES, COORDINATES)
TURNS = st.floats(0.01, 4.5 * pi).flatmap(lambda turn: st.sampled_from((turn, -turn)))


def written(
    start: Point, moves: list[Move], frame: Frame, form: HelixForm
) -> tuple[WrittenCurve, tuple[Segment, ...]]:
    draft = Draft(Program(Part21File.from_bytes(EMPTY)))
    curve = CurveWriter(draft, frame, form).curve(start, moves)
    program = Program(Part21File.from_bytes(draft.edits.apply()))
    found = segments_of(program, Ref(int(curve.ref)))
    return curve, tuple(segment.within(frame) for segment in found)


def line(end: Point) -> Move:
    return Move(end=end, type=MoveType.CONTACT)


def bend(
    start: Point, *, radius: float, turn: float, plane: ArcPlane, rise: float = 0.0
) -> Move:
    first, second, normal = plane.axes
    end, centre = list(start), list(start)
    centre[first] -= radius
    end[first] = centre[first] + radius * cos(turn)
    end[second] = centre[second] + radius * sin(turn)
    end[normal] += rise
    arc = Arc(centre=(centre[0], centre[1], centre[2]), turn=turn, plane=plane)
    return Move(end=(end[0], end[1], end[2]), type=MoveType.CONTACT, arc=arc)


@given(
    start=POINTS, ends=st.lists(POINTS, min_size=1, max_size=5), frame=st.sampled_from(FRAMES)
)
def test_lines_come_back(start: Point, ends: list[Point], frame: Frame) -> None:
    corners = [start]
    for end in ends:
        if max(abs(a - b) for a, b in zip(end, corners[-1], strict=True)) > 0.01:
            corners.append(end)
    if len(corners) < 2:
        return
    moves = [line(end) for end in corners[1:]]
    curve, found = written(start, moves, frame, HelixForm.HELIX)
    assert [segment.end for segment in found] == [pytest.approx(m.end) for m in moves]
    assert sum(curve.lengths) == pytest.approx(
        sum(length(a, m) for a, m in zip(corners[:-1], moves, strict=True))
    )


@given(
    start=POINTS,
    radius=st.floats(0.5, 80.0),
    turn=TURNS,
    plane=st.sampled_from(ArcPlane),
    frame=st.sampled_from(FRAMES),
)
def test_arcs_come_back_as_arcs(
    start: Point, radius: float, turn: float, plane: ArcPlane, frame: Frame
) -> None:
    before = (start[0] + 5.0, start[1], start[2])
    move = bend(start, radius=radius, turn=turn, plane=plane)
    after = (move.end[0], move.end[1] + 3.0, move.end[2] + 1.0)
    moves = [line(start), move, line(after)]
    curve, found = written(before, moves, frame, HelixForm.CHORDS)
    arcs = [m for s in found[1:-1] for m in move_of(s, MoveType.CONTACT, None)]
    assert all(each.arc is not None and each.arc.plane is plane for each in arcs)
    assert sum(each.arc.turn for each in arcs if each.arc) == pytest.approx(turn, abs=1e-6)
    assert found[0].end == pytest.approx(start, abs=1e-9)
    assert found[-2].end == pytest.approx(move.end, abs=1e-9)
    assert curve.lengths[1] == pytest.approx(radius * abs(turn))


@given(
    radius=st.floats(0.5, 80.0),
    turn=TURNS,
    plane=st.sampled_from(ArcPlane),
    rise=st.floats(0.01, 20.0).flatmap(lambda rise: st.sampled_from((rise, -rise))),
    frame=st.sampled_from(FRAMES),
)
def test_a_helix_comes_back_exactly(
    radius: float, turn: float, plane: ArcPlane, rise: float, frame: Frame
) -> None:
    move = bend((1.0, 2.0, 3.0), radius=radius, turn=turn, plane=plane, rise=rise)
    curve, (found,) = written((1.0, 2.0, 3.0), [move], frame, HelixForm.HELIX)
    (back,) = move_of(found, MoveType.CONTACT, None)
    assert back.arc is not None
    assert back.arc.turn == pytest.approx(turn, abs=1e-6)
    assert back.end == pytest.approx(move.end, abs=1e-9)
    assert curve.lengths[0] == pytest.approx(hypot(radius * turn, rise))


@settings(max_examples=20)
@given(radius=st.floats(0.5, 80.0), turn=TURNS, frame=st.sampled_from(FRAMES))
def test_chords_of_a_helix_keep_their_tolerance(
    radius: float, turn: float, frame: Frame
) -> None:
    """The middle of each chord lies within the tolerance of the helix."""
    start = (radius, 0.0, 0.0)
    move = bend(start, radius=radius, turn=turn, plane=ArcPlane.XY, rise=-4.0)
    curve, found = written(start, [move], frame, HelixForm.CHORDS)
    assert all(segment.bend is None for segment in found)
    for segment in found:
        x, y, z = (0.5 * (a + b) for a, b in zip(segment.start, segment.end, strict=True))
        assert abs(hypot(x, y) - radius) <= CHORD_TOLERANCE
        off = (atan2(y, x) - turn * z / -4.0) % (2.0 * pi)
        assert min(off, 2.0 * pi - off) * radius <= CHORD_TOLERANCE
    assert curve.lengths[0] == pytest.approx(hypot(radius * turn, 4.0), rel=1e-3)
