"""How the tool comes down to a pass and leaves it."""

from math import dist, pi, radians, tan
from pathlib import Path

import pytest

from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.arc import length, points_along
from stepnc_model.toolpath.milling.contour import Chain, circle, line, polygon
from stepnc_model.toolpath.milling.cover import MillingPass
from stepnc_model.toolpath.milling.enter import Heights, enter, leave, trace
from stepnc_model.toolpath.milling.layer import CentreArea, Clearance, nowhere, within
from stepnc_model.toolpath.path import MoveType, ToolPath
from stepnc_model.toolpath.task import PathBuilder, ToolPathTask, job_of

PARTS = Path(__file__).parents[4] / "examples" / "parts"
END = "ENDSEC;\nEND-ISO-10303-21;"


def edited(*changes: tuple[str, str], more: str = "") -> Program:
    """The bracket with some texts replaced and instances added."""
    text = (PARTS / "bracket.stpnc").read_text(encoding="utf-8")
    for before, after in (*changes, (END, f"{more}\n{END}")):
        assert before in text, before
        text = text.replace(before, after)
    return Program(Part21File.from_bytes(text.encode(), name="bracket"))


def job_at(id: str, *changes: tuple[str, str], more: str = "") -> ToolPathTask:
    """Job of the workingstep with a name."""
    program = edited(*changes, more=more)
    step = next(step for step in program.workingsteps if step.id == id)
    return job_of(program, step)


RING = MillingPass(circle(0j, 20.0), is_closed=True)
STROKE = MillingPass((line(0j, 8 + 0j), line(8 + 0j, 8 + 30j)), is_closed=False)
ROOM = within([RING.chain])
HEIGHTS = Heights(travel=20.0, retract=10.0, above=0.5, level=-4.0)
DROP = 4.5


def entered(
    strategy: str, cut: MillingPass = RING, clearance: Clearance = ROOM, side: complex = 1j
) -> tuple[ToolPath, MillingPass]:
    """From the start over the pass down to it."""
    job = job_at("ROUGH POCKET", ("#342=PLUNGE_RAMP($,3.)", f"#342={strategy}"))
    course = PathBuilder(job, (0.0, 0.0, 50.0))
    room = CentreArea(clearance=clearance, side=side)
    rest = enter(course, job, cut, heights=HEIGHTS, room=room, approach=Ref(342))
    return course.finished(), rest


def slopes(path: ToolPath) -> list[float]:
    """Tangents of all moves that sink at the feed through the material."""
    found = []
    for start, move in path.segments():
        if move.type is MoveType.APPROACH and move.feed is not None:
            drop = start[2] - move.end[2]
            found.append(drop / (length(start, move) ** 2 - drop**2) ** 0.5)
    return found


def at_start(path: ToolPath, cut: MillingPass) -> bool:
    return dist(path.end, (cut.start.real, cut.start.imag, -4.0)) < 1e-9


def test_plunge_goes_straight_down_in_rapid_to_the_retract_plane_and_then_feeds() -> None:
    path, rest = entered("PLUNGE_TOOLAXIS($)")
    assert [(m.end[2], m.feed is None) for m in path.moves] == [
        (50.0, True),
        (20.0, True),
        (10.0, True),
        (0.5, False),
        (-4.0, False),
    ]
    assert {move.end[:2] for move in path.moves} == {(20.0, 0.0)}
    assert rest is RING


def test_ramp_goes_round_the_ring_at_its_angle_and_leaves_a_whole_ring() -> None:
    path, rest = entered("PLUNGE_RAMP($,1.)")
    assert slopes(path) == pytest.approx([tan(radians(1.0))] * len(slopes(path)), abs=1e-9)
    assert all(move.arc is not None for move in path.moves[4:])
    assert at_start(path, rest)
    assert sum(edge.length for edge in rest.chain) == pytest.approx(40.0 * pi)
    sunk = sum(
        length(a, m) for a, m in path.segments() if m.type is MoveType.APPROACH and m.feed
    )
    assert sunk == pytest.approx(DROP / tan(radians(1.0)), rel=1e-3)


def test_ramp_on_a_stroke_goes_to_and_fro_around_its_corner() -> None:
    path, rest = entered("PLUNGE_RAMP($,5.)", STROKE)
    assert rest is STROKE
    assert at_start(path, STROKE)
    assert slopes(path) == pytest.approx([tan(radians(5.0))] * len(slopes(path)), abs=1e-9)
    assert any(move.end[1] > 1.0 for move in path.moves)


def test_zigzag_stays_within_its_width() -> None:
    path, _ = entered("PLUNGE_ZIGZAG($,5.,6.)", STROKE)
    assert max(move.end[0] for move in path.moves) <= 6.0 + 1e-9
    assert slopes(path) == pytest.approx([tan(radians(5.0))] * len(slopes(path)), abs=1e-9)
    assert at_start(path, STROKE)


def test_helix_is_one_arc_on_the_free_side_at_its_angle() -> None:
    path, rest = entered("PLUNGE_HELIX($,5.,2.)")
    *_, (start, helix) = path.segments()
    assert helix.arc is not None
    assert helix.arc.turn == pytest.approx(DROP / tan(radians(2.0)) / 5.0)
    assert helix.arc.centre[:2] == pytest.approx((15.0, 0.0))
    assert start[2] == 0.5
    assert at_start(path, rest)
    assert slopes(path)[-1] == pytest.approx(tan(radians(2.0)), abs=1e-9)


def test_helix_that_does_not_fit_is_made_smaller_and_then_a_ramp() -> None:
    path, _ = entered("PLUNGE_HELIX($,30.,2.)")
    assert path.moves[-1].arc is not None
    assert path.findings == ()
    path, _ = entered("PLUNGE_HELIX($,30.,2.)", clearance=nowhere)
    assert "no room for the helix" in path.findings[0].message


@pytest.mark.parametrize("strategy", ["AP_RETRACT_TANGENT($,4.)", "AP_RETRACT_ANGLE($,30.,6.)"])
@pytest.mark.parametrize("side", [1j, -1j])
def test_air_strategies_come_from_the_free_side_and_stay_in_the_room(
    strategy: str, side: complex
) -> None:
    cut = (
        RING
        if side == 1j
        else MillingPass(tuple(e.reversed() for e in RING.chain[::-1]), is_closed=True)
    )
    path, _ = entered(strategy, cut, side=side)
    assert path.findings == ()
    assert at_start(path, cut)
    *_, (start, last) = path.segments()
    for x, y, _ in [start, *points_along(start, last, step=0.01)]:
        assert abs(complex(x, y)) <= 20.0 + 1e-6


def test_tangent_arc_meets_the_pass_along_its_way() -> None:
    """A quarter of 4 mm about a point 4 mm inside the ring: from (16, -4)."""
    path, _ = entered("AP_RETRACT_TANGENT($,4.)")
    *_, (start, last) = path.segments()
    assert start == pytest.approx((16.0, -4.0, -4.0))
    assert last.arc is not None
    assert last.arc.turn == pytest.approx(0.5 * pi)


def test_angle_meets_the_pass_at_its_angle() -> None:
    """30° to the tangent, 6 mm long: 3 mm inside the ring."""
    path, _ = entered("AP_RETRACT_ANGLE($,30.,6.)")
    *_, (start, _last) = path.segments()
    assert start[:2] == pytest.approx((17.0, -6.0 * 0.75**0.5))


def test_lead_without_room_is_left_out_and_said() -> None:
    path, _ = entered("AP_RETRACT_TANGENT($,25.)")
    assert (
        "no room for ap_retract_tangent: moving straight down"
        in path.findings[0].message.lower()
    )
    path, _ = entered("AP_RETRACT_TANGENT($,1.)", clearance=nowhere)
    assert path.findings


@pytest.mark.parametrize("angle", ["0.", "-3.", "90."])
def test_angle_that_is_no_ramp_is_said(angle: str) -> None:
    path, _ = entered(f"PLUNGE_RAMP($,{angle})")
    assert "is not a valid ramp: moving straight down" in path.findings[0].message


def test_ramp_on_a_speck_is_a_plunge_and_said() -> None:
    path, _ = entered("PLUNGE_RAMP($,1.)", MillingPass(circle(0j, 0.01), is_closed=True))
    assert "straight down" in path.findings[0].message
    assert len(path.moves) == 5


def left(strategy: str, clearance: Clearance = ROOM) -> ToolPath:
    job = job_at("ROUGH POCKET", ("#341=AP_RETRACT_TANGENT($,5.)", f"#341={strategy}"))
    course = PathBuilder(job, (20.0, 0.0, -4.0))
    leave(
        course,
        job,
        RING,
        heights=HEIGHTS,
        room=CentreArea(clearance=clearance),
        retract=Ref(341),
    )
    return course.finished()


def test_tool_leaves_along_an_arc_and_straight_up() -> None:
    arc, up = left("AP_RETRACT_TANGENT($,4.)").moves
    assert arc.end == pytest.approx((16.0, 4.0, -4.0))
    assert up.end == pytest.approx((16.0, 4.0, 20.0))
    assert up.feed is None


def test_retract_without_room_goes_straight_up_and_is_said() -> None:
    path = left("AP_RETRACT_TANGENT($,4.)", nowhere)
    assert [move.end for move in path.moves] == [(20.0, 0.0, 20.0)]
    assert "straight up" in path.findings[0].message


def test_trace_sinks_evenly_along_lines_and_arcs() -> None:
    job = job_at("ROUGH POCKET")
    course = PathBuilder(job, (0.0, 0.0, 0.0))
    chain: Chain = polygon([0j, 30 + 0j, 30 + 10j, 10j])
    trace(course, chain, z=0.0, end_z=-8.0, type=MoveType.APPROACH)
    assert [move.end[2] for move in course.finished().moves] == pytest.approx([-3, -4, -7, -8])
