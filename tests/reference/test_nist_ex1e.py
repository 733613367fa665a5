"""Explicit tool paths of NIST's ``ex1E.stp``, and the hole of ``ex1.stp``.

NIST made ``ex1.canonical.txt`` from ``ex1.stp`` with an interpreter of its own, and wrote the
positions found there into ``ex1E.stp`` as explicit tool paths. So the positions of that file,
as they are followed here, must be those of the canonical one, in order.

Repeated positions count once. The canonical file has seven positions more; all of them lie on
the security plane at z = 30 mm or above it, on NIST's ways from one workingstep to the next,
which ``ex1E.stp`` leaves to the control. No position of ``ex1E.stp`` is missing in the other.
"""

import re
from itertools import pairwise
from pathlib import Path

import pytest

from stepnc_model.programs.program import Program
from stepnc_model.toolpath.explicit.operation import explicit_path, rapid_movement_path
from stepnc_model.toolpath.hole.operation import hole_path
from stepnc_model.toolpath.path import Move, MoveType, Point, SpindleCommand, ToolPath
from stepnc_model.toolpath.task import job_of

CORPUS = Path(__file__).parents[3] / "shared" / "corpus" / "iso14649"
EXPLICIT, FEATURES, CANONICAL = (
    CORPUS / name for name in ("ex1E.stp", "ex1.stp", "ex1.canonical.txt")
)

pytestmark = pytest.mark.skipif(
    not CANONICAL.exists(), reason="NIST's example files are not beside the project"
)

TOLERANCE = 1e-4
"""mm, the last digit of both files"""

OVER_THE_SECURITY_PLANE = {
    14: (91.9, -13.5, 200.0),
    52: (6.4, -13.5, 30.0),
    53: (20.0, 60.0, 30.0),
    86: (20.0, 60.0, 30.0),
    87: (64.754, 50.0685, 30.0),
    207: (70.0, 100.0, 30.0),
    208: (74.8901, 60.2846, 30.0),
}
"""positions, by line of the canonical file, that ``ex1E.stp`` does not have"""


def is_same(one: Point, other: Point) -> bool:
    return all(abs(a - b) <= TOLERANCE for a, b in zip(one, other, strict=True))


def canonical() -> list[tuple[int, Point]]:
    """Lines of the canonical file with the positions they lead to."""
    found = []
    for number, text in enumerate(CANONICAL.read_text(encoding="latin-1").splitlines(), 1):
        match = re.search(r"(STRAIGHT_FEED|STRAIGHT_TRAVERSE|ARC_FEED)\((.*)\)", text)
        if match:
            numbers = [float(each) for each in match[2].split(",")]
            found.append((number, (numbers[0], numbers[1], numbers[-1])))
    return found


def explicit_paths() -> list[ToolPath]:
    """Paths of all executables, in order."""
    program = Program.load(EXPLICIT)
    steps = {step.ref: step for step in program.workingsteps}
    paths = []
    for executable in program.executables:
        if executable.ref in steps:
            paths.append(explicit_path(job_of(program, steps[executable.ref])))
        elif executable.keyword == "RAPID_MOVEMENT":
            path = rapid_movement_path(program, executable)
            assert path is not None
            paths.append(path)
    return paths


def without_repeats(points: list[Point]) -> list[Point]:
    kept: list[Point] = []
    for point in points:
        if not kept or not is_same(kept[-1], point):
            kept.append(point)
    return kept


def test_the_positions_left_out_are_in_the_canonical_file() -> None:
    lines = dict(canonical())
    assert {number: lines[number] for number in OVER_THE_SECURITY_PLANE} == (
        OVER_THE_SECURITY_PLANE
    )


def test_every_position_is_that_of_nist_in_order() -> None:
    expected = without_repeats([
        point for number, point in canonical() if number not in OVER_THE_SECURITY_PLANE
    ])
    found = without_repeats([
        point for path in explicit_paths() for point in (path.start, *_ends(path))
    ])
    assert len(found) == len(expected) == 483
    differing = [pair for pair in zip(found, expected, strict=True) if not is_same(*pair)]
    assert differing == []


def test_arcs_turn_as_often_and_the_same_way_as_those_of_nist() -> None:
    """ARC_FEED(x, y, centre x, centre y, turns, z): −3 is clockwise, more than two turns."""
    expected = []
    for text in CANONICAL.read_text(encoding="latin-1").splitlines():
        match = re.search(r"ARC_FEED\((.*)\)", text)
        if match:
            x, y, cx, cy, turns, z = (float(each) for each in match[1].split(","))
            expected.append((cx, cy, turns, (x, y, z)))
    moves = [move for path in explicit_paths() for move in path.moves if move.arc is not None]
    assert len(moves) == len(expected)
    for move, (cx, cy, turns, end) in zip(moves, expected, strict=True):
        assert move.arc is not None
        assert move.arc.centre[:2] == pytest.approx((cx, cy), abs=TOLERANCE)
        assert -move.arc.turn / 6.283185307179586 > -turns - 1.0
        assert -move.arc.turn / 6.283185307179586 <= -turns + 1e-4
        assert is_same(move.end, end)


def test_paths_that_go_on_where_the_last_one_ended_start_there() -> None:
    """All of the pocket: between its 36 paths there is one gap, before finishing."""
    paths = explicit_paths()[6:]
    gaps = [
        index
        for index, (one, other) in enumerate(pairwise(paths))
        if not is_same(one.end, other.start)
    ]
    assert [paths[index + 1].id for index in gaps] == ["WS FINISH POCKET1 A"]


def test_each_way_into_the_hole_has_a_technology_of_its_own() -> None:
    """Canonical lines 51-63: 900, 1800, 1350 and 1800 mm/min."""
    program = Program.load(EXPLICIT)
    (step,) = (step for step in program.workingsteps if step.id == "WS DRILL HOLE1")
    path = explicit_path(job_of(program, step))
    feeds = [program.get(move.feed.technology) for move in path.moves if move.feed]
    assert [getattr(feed, "feedrate", None) for feed in feeds] == [0.015, 0.03, 0.0225, 0.03]


class TestHole:
    """Lines 53-63 and 68-76 of the canonical file.

    NIST's drill has its full diameter 7.1378 mm above its tip, ours 7.1402 mm: the corner of
    radius 2 mm about a centre 8 mm beside the axis, at 31 degrees, 8·tan 31° + 2/cos 31°.
    """

    POINT_DIFFERENCE = 7.1402 - 7.1378

    def path(self, name: str) -> ToolPath:
        program = Program.load(FEATURES)
        (step,) = (step for step in program.workingsteps if step.id == name)
        return hole_path(job_of(program, step))

    def test_the_drill_goes_as_deep_by_the_same_stages(self) -> None:
        moves = self.path("WS DRILL HOLE1").moves
        assert [move.end[:2] for move in moves] == [(20.0, 60.0)] * len(moves)
        heights = [move.end[2] for move in moves]
        assert heights[0] == 10.0
        expected = (-9.1378, -15.1378, -37.1378)
        assert heights[1:4] == pytest.approx(
            [z - self.POINT_DIFFERENCE for z in expected], abs=5e-5
        )
        assert heights[4:] == [10.0, 30.0]

    def test_its_feeds_and_speeds_are_those_of_nist(self) -> None:
        """900, 1800, 1350 and 1800 of 1800 mm/min; 720, 960, 480 and 480 of 960 rpm."""
        feeds = [move.feed for move in self.path("WS DRILL HOLE1").moves if move.feed]
        assert [feed.ratio for feed in feeds] == [0.5, 1.0, 0.75, 1.0]
        assert [feed.speed_ratio for feed in feeds] == [0.75, 1.0, 0.5, 0.5]

    def test_the_reamer_stops_its_spindle_at_the_bottom(self) -> None:
        path = self.path("WS REAM HOLE1")
        kinds = [
            step if isinstance(step, SpindleCommand) else step.type
            for step in path.steps
            if isinstance(step, (SpindleCommand, Move))
        ]
        assert [move.end[2] for move in path.moves] == [10.0, -30.0, 10.0, 30.0]
        assert kinds == [
            MoveType.RAPID,
            MoveType.CONTACT,
            SpindleCommand.STOP,
            MoveType.RETRACT,
            SpindleCommand.START,
            MoveType.RAPID,
        ]


def _ends(path: ToolPath) -> list[Point]:
    return [move.end for move in path.moves]
