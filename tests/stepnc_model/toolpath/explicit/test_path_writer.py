"""Explicit tool paths written into a file: what reading them gives, and what else changes."""

from dataclasses import replace
from itertools import accumulate
from math import dist

import pytest
from hypothesis import given
from hypothesis import strategies as st
from steputils import p21

from stepnc_model.editing.file_profile import FileProfile
from stepnc_model.entities.entity import Entity
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.arc import length
from stepnc_model.toolpath.explicit.operation import path_frames
from stepnc_model.toolpath.explicit.path_writer import MOST_MOVES, write_paths
from stepnc_model.toolpath.explicit.planned_path import MovePart, PlannedMove, PlannedPath
from stepnc_model.toolpath.generate import workingstep_path
from stepnc_model.toolpath.path import Dwell, Feed, Move, MoveType, Point, ToolPath
from tests.stepnc_model.toolpath.explicit.test_operation import FILE

START = (100.0, 0.0, 30.0)
TECHNOLOGY = Ref[Entity](60)
OTHER = "#62=MILLING_TECHNOLOGY(0.02,.TCP.,$,-10.,$,.F.,.F.,.F.,$);\nENDSEC;\nEND"
FEEDS = st.lists(
    st.tuples(
        st.floats(0.5, 20.0),
        st.lists(st.sampled_from((0.2, 0.75, 1.0, 1.3, 7.0)), min_size=1, max_size=4),
    ),
    min_size=1,
    max_size=6,
)


def sample() -> Program:
    return Program(Part21File.from_bytes(FILE.replace("ENDSEC;\nEND", OTHER).encode()))


def rapid(end: Point) -> PlannedMove:
    return PlannedMove(move=Move(end=end, type=MoveType.RAPID))


def fed(
    end: Point,
    *factors: float,
    type: MoveType = MoveType.CONTACT,
    technology: Ref[Entity] = TECHNOLOGY,
) -> PlannedMove:
    """Move with equal parts of several factors."""
    parts = tuple(
        MovePart(end=(row + 1) / len(factors), factor=factor)
        for row, factor in enumerate(factors)
    )
    return PlannedMove(
        move=Move(end=end, type=type, feed=Feed(technology=technology)), parts=parts
    )


def written(
    *steps: PlannedMove | Dwell,
    program: Program | None = None,
    profile: FileProfile = FileProfile.OPTIMISATION,
) -> bytes:
    program = program or sample()
    step = program.workingsteps[0]
    path = PlannedPath(step=step, frame=path_frames(program, step)[0], start=START, steps=steps)
    return write_paths(program, [path], profile)


def read(data: bytes) -> ToolPath:
    program = Program(Part21File.from_bytes(data))
    return workingstep_path(program, program.workingsteps[0])


def planned_along(feeds: list[tuple[float, list[float]]]) -> list[PlannedMove]:
    """Moves along x, and around corners, from the start."""
    moves: list[PlannedMove] = []
    x, y, z = START
    for row, (size, factors) in enumerate(feeds):
        x, y = (x + size, y) if row % 2 == 0 else (x, y + size)
        moves.append(fed((x, y, z), *factors))
    return moves


@given(feeds=FEEDS, profile=st.sampled_from(FileProfile))
def test_what_is_read_is_never_faster_than_planned(
    feeds: list[tuple[float, list[float]]], profile: FileProfile
) -> None:
    moves = planned_along(feeds)
    found = read(written(*moves, profile=profile))
    assert found.start == pytest.approx(START)
    assert found.end == pytest.approx(moves[-1].move.end)
    ends = list(accumulate(size for size, _ in feeds))
    planned = [
        (end - size + part.end * size, part.factor)
        for move, end, (size, _) in zip(moves, ends, feeds, strict=True)
        for part in move.parts
    ]
    begin = 0.0
    for start, move in found.segments():
        end = begin + length(start, move)
        assert move.feed is not None
        for share in (0.001, 0.5, 0.999):
            at = begin + share * (end - begin)
            limit = next(factor for stop, factor in planned if at <= stop + 1e-9)
            assert move.feed.ratio <= limit
        begin = end


@given(feeds=FEEDS)
def test_reading_takes_hardly_longer_than_planned(
    feeds: list[tuple[float, list[float]]],
) -> None:
    """Each change of the factor costs at most a ramp at the slower feed."""
    moves = planned_along(feeds)
    planned = sum(size / len(f) / factor for size, f in feeds for factor in f)
    found = read(written(*moves))
    taken = sum(
        length(start, move) / move.feed.ratio for start, move in found.segments() if move.feed
    )
    count = sum(len(factors) for _, factors in feeds)
    assert planned - 1e-6 <= taken <= planned + 0.01 / 0.2 * count


def test_rapids_pauses_and_types_come_back() -> None:
    found = read(
        written(
            rapid((120.0, 0.0, 30.0)),
            fed((120.0, 0.0, 8.0), 0.3, type=MoveType.APPROACH),
            Dwell(seconds=0.5),
            fed((120.0, 9.0, 8.0), 1.0),
            fed((120.0, 12.0, 8.0), 2.0, type=MoveType.NO_CONTACT),
            rapid((120.0, 12.0, 30.0)),
        )
    )
    types = [step.type if isinstance(step, Move) else step for step in found.steps]
    assert types == [
        MoveType.RAPID,
        MoveType.APPROACH,
        Dwell(seconds=0.5),
        MoveType.CONTACT,
        MoveType.NO_CONTACT,
        MoveType.RAPID,
    ]
    ratios = [move.feed and move.feed.ratio for move in found.moves]
    assert ratios == [None, 0.3, 1.0, 2.0, None]
    assert found.findings == ()


def test_a_technology_of_another_kind_is_kept() -> None:
    found = read(
        written(fed((105.0, 0.0, 30.0), 0.5), fed((109.0, 0.0, 30.0), 0.5, technology=Ref(62)))
    )
    technologies = [int(move.feed.technology) for move in found.moves if move.feed]
    assert technologies == [60, 62]


def test_a_long_path_becomes_several_trajectories() -> None:
    moves = [fed((100.0 + row, 0.0, 30.0), 1.0) for row in range(1, 2 * MOST_MOVES + 2)]
    data = written(*moves)
    assert data.count(b"=CUTTER_LOCATION_TRAJECTORY(") == 3 + 1
    assert len(read(data).moves) == len(moves)


def test_moves_without_length_are_left_out() -> None:
    found = read(written(fed(START, 0.1), fed((105.0, 0.0, 30.0), 1.0, 2.0)))
    assert [move.feed.ratio for move in found.moves if move.feed] == [1.0, 2.0]


def test_other_bytes_stay() -> None:
    """The former path of the operation goes, but not a point that others use."""
    before = sample().file.data.splitlines()
    after = written(fed((105.0, 0.0, 30.0), 1.0, 2.0)).splitlines()
    gone = [row.split(b"=")[0] for row in before if row not in after]
    assert gone == [b"#10", b"#11", b"#12", b"#13", b"#31"]


def test_writing_again_replaces_what_was_written() -> None:
    moves = fed((105.0, 0.0, 30.0), 1.0, 2.0), fed((105.0, 9.0, 30.0), 0.5)
    once = written(*moves)
    assert written(*moves, program=Program(Part21File.from_bytes(once))) == once


def test_another_reader_accepts_the_file() -> None:
    data = written(rapid((120.0, 0.0, 30.0)), fed((105.0, 0.0, 30.0), 1.0, 2.0))
    (section,) = p21.loads(data.decode()).data
    names = [each.entity.name for each in section.instances.values()]
    assert names.count("B_SPLINE_CURVE_WITH_KNOTS") == 1
    assert names.count("TOOLPATH_SPEED") == 1
    found = Program(Part21File.from_bytes(data)).findings()
    assert [replace(each, line=0) for each in found] == [
        replace(each, line=0) for each in sample().findings()
    ]


def test_the_file_gives_the_path_in_the_coordinates_of_the_feature() -> None:
    """The feature is at (100, 0, 10), turned by a right angle."""
    data = written(fed((100.0, 5.0, 10.0), 1.0)).decode()
    points = [row for row in data.splitlines() if "CARTESIAN_POINT('',(5." in row]
    assert any("(5.,0.,0.)" in row.replace("-0.", "0.") for row in points)
    assert dist(read(data.encode()).end, (100.0, 5.0, 10.0)) < 1e-9
