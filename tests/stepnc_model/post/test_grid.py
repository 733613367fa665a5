"""Rounding first, arcs afterwards."""

from math import atan2, cos, dist, hypot, pi, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.post.blocks import (
    Block,
    Circular,
    DrillingCycle,
    Linear,
    Rapid,
    Rate,
    Retract,
    RigidTap,
    ThreadingMove,
)
from stepnc_model.post.grid import (
    cut,
    end_of,
    flat,
    merged,
    on_grid,
    pieces,
    rounded,
    single_turns,
    turns,
)
from stepnc_model.toolpath.arc import point_at
from stepnc_model.toolpath.path import Arc, CycleKind, Point

RATE = Rate(value=1.0)
ORIGIN = (0.0, 0.0, 0.0)
PLACES = 3
UNIT = 10.0**-PLACES


def arc(start: Point, centre: Point, turn: float, rise: float = 0.0) -> Circular:
    u, v = start[0] - centre[0], start[1] - centre[1]
    angle = atan2(v, u) + turn
    size = hypot(u, v)
    end = (centre[0] + size * cos(angle), centre[1] + size * sin(angle), start[2] + rise)
    return Circular(end=end, arc=Arc(centre=centre, turn=turn), rate=RATE)


coordinates = st.floats(-300.0, 300.0)
arcs = st.builds(
    arc,
    start=st.just(ORIGIN),
    centre=st.tuples(coordinates, coordinates, st.just(0.0)),
    turn=st.one_of(st.floats(-20.0, 20.0), st.sampled_from([2 * pi, -4 * pi, 2 * pi - 1e-5])),
    rise=st.sampled_from([0.0, 5.0]),
)


@given(arcs)
def test_both_radii_of_every_arc_agree_within_the_rounding(block: Circular) -> None:
    """Half a unit in each of two axes, along the chord at both ends: √2 units."""
    at: Point = ORIGIN
    for piece in on_grid([block], PLACES):
        assert isinstance(piece, (Circular, Linear))
        if isinstance(piece, Circular):
            centre = piece.arc.centre
            radii = [hypot(p[0] - centre[0], p[1] - centre[1]) for p in (at, piece.end)]
            assert abs(radii[0] - radii[1]) <= 1.5 * UNIT
        at = piece.end


@given(arcs)
def test_the_path_ends_where_it_should_and_goes_round_as_often(block: Circular) -> None:
    found = list(on_grid([block], PLACES))
    if not found:
        assert dist(ORIGIN, block.end) < 2.0 * UNIT
        return
    assert end_of(found[-1], ORIGIN) == rounded(block.end, PLACES)
    size = hypot(block.arc.centre[0], block.arc.centre[1])
    if size < 0.01:
        return
    total = sum(piece.arc.turn for piece in found if isinstance(piece, Circular))
    # What is left out is a line of a few units, which is less of a turn on a greater radius.
    assert total == pytest.approx(block.arc.turn, abs=max(1e-5, 10.0 * UNIT / size))


@given(arcs)
def test_no_point_of_an_arc_strays(block: Circular) -> None:
    """The middle of each piece lies on the programmed circle, two units of rounding beside."""
    size = hypot(block.arc.centre[0], block.arc.centre[1])
    at: Point = ORIGIN
    for piece in on_grid([block], PLACES):
        if isinstance(piece, Circular):
            x, y, _ = point_at(at, piece, 0.5)
            beside = hypot(x - block.arc.centre[0], y - block.arc.centre[1]) - size
            assert abs(beside) <= 2.5 * UNIT
        at = end_of(piece, at)


def test_an_arc_below_the_grid_is_a_line() -> None:
    tiny = arc((0.0, 0.0, 0.0), (0.001, 0.0, 0.0), pi)
    assert list(on_grid([tiny], PLACES)) == [Linear(end=(0.002, 0.0, 0.0), rate=RATE)]


def test_a_short_arc_of_a_large_radius_never_becomes_a_full_circle() -> None:
    """Its ends round to a chord that points backwards."""
    short = arc((0.0, 0.0, 0.0), (0.0, 100.0, 0.0), 1e-5)
    for piece in on_grid([short], PLACES):
        assert not isinstance(piece, Circular) or abs(piece.arc.turn) < 0.1


@pytest.mark.parametrize("turn", [2 * pi, -6 * pi])
def test_full_turns_come_back_exactly(turn: float) -> None:
    (piece,) = on_grid([arc(ORIGIN, (12.3456, -7.8912, 0.0), turn, rise=3.0)], PLACES)
    assert isinstance(piece, Circular)
    assert piece.end == (0.0, 0.0, 3.0)
    assert piece.arc.turn == turn


def test_a_nearly_full_circle_is_cut_in_two() -> None:
    found = pieces(ORIGIN, arc(ORIGIN, (10.0, 0.0, 0.0), 6.0))
    assert [abs(piece.arc.turn) for piece in found] == [3, 3]


def test_turns_are_full_ones_and_the_rest() -> None:
    """Two and a half turns that rise by 5 mm: 2 mm in each full one."""
    found = list(turns(ORIGIN, arc(ORIGIN, (10.0, 0.0, 0.0), -5.0 * pi, rise=5.0)))
    assert [p.arc.turn for p in found] == pytest.approx([-2 * pi, -2 * pi, -pi])
    assert [p.end[2] for p in found] == pytest.approx([2.0, 4.0, 5.0])
    assert found[0].end[:2] == (0.0, 0.0)
    assert found[2].end[0] == pytest.approx(20.0)


def test_one_part_is_the_arc_itself() -> None:
    block = arc(ORIGIN, (1.0, 0.0, 0.0), 1.0)
    assert list(cut(ORIGIN, block, [1.0])) == [block]


def test_single_turns_know_where_they_start() -> None:
    start = (5.0, 0.0, 1.0)
    blocks: list[Block] = [Rapid(end=start), arc(start, (0.0, 0.0, 0.0), 4 * pi, rise=2.0)]
    _, first, second = single_turns(blocks)
    assert isinstance(first, Circular)
    assert isinstance(second, Circular)
    assert first.end == (5.0, 0.0, 2.0)
    assert second.end == pytest.approx((5.0, 0.0, 3.0))


def test_lines_that_round_to_nothing_vanish() -> None:
    blocks = [Linear(end=(1.0, 0.0, 0.0), rate=RATE), Linear(end=(1.0004, 0.0, 0.0), rate=RATE)]
    assert len(list(on_grid(blocks, PLACES))) == 1
    assert not list(on_grid([ThreadingMove(end=(0.0004, 0.0, 0.0), lead=1.0)], PLACES))


def test_no_zero_is_negative() -> None:
    (block,) = on_grid([Rapid(end=(-0.0001, -0.0, 0.0))], PLACES)
    assert isinstance(block, Rapid)
    assert str(block.end) == "(0.0, 0.0, 0.0)"


def drilling(x: float) -> DrillingCycle:
    return DrillingCycle(
        kind=CycleKind.DRILL,
        at=(x, 0.0),
        retract_z=2.0,
        bottom_z=-5.0,
        rate=RATE,
        expansion=(Linear(end=(x, 0.0, -5.0), rate=RATE), Rapid(end=(x, 0.0, 2.0))),
    )


def test_cycles_that_are_not_kept_become_what_they_stand_for() -> None:
    assert list(flat([drilling(1.0)])) == list(drilling(1.0).expansion)
    assert list(flat([drilling(1.0)], lambda cycle: cycle.at[0] > 0.0)) == [drilling(1.0)]


def test_ways_between_cycles_are_merged_into_them() -> None:
    blocks: list[Block] = [
        Rapid(end=(1.0, 0.0, 2.0)),
        drilling(1.0),
        Rapid(end=(2.0, 0.0, 2.0)),
        drilling(2.0),
        Rapid(end=(3.0, 0.0, 2.0)),
        Retract(z=50.0),
    ]
    kept = [block for index, block in enumerate(blocks) if index != 2]
    assert list(merged(blocks)) == kept


@pytest.mark.parametrize("z", [2.0, 9.0])
def test_other_ways_between_cycles_stay(z: float) -> None:
    blocks: list[Block] = [drilling(1.0), Rapid(end=(5.0, 0.0, z)), drilling(2.0)]
    assert list(merged(blocks)) == blocks


def test_a_last_way_is_not_lost() -> None:
    blocks: list[Block] = [drilling(1.0), Rapid(end=(5.0, 0.0, 2.0))]
    assert list(merged(blocks)) == blocks


def test_a_tap_ends_where_it_began() -> None:
    tap = RigidTap(start=(1.0, 2.0, 3.0), bottom_z=-4.0, lead=1.0, speed=1.0)
    assert end_of(tap, ORIGIN) == (1.0, 2.0, 3.0)
    assert end_of(drilling(4.0), ORIGIN) == (4.0, 0.0, 2.0)
    assert end_of(Retract(z=7.0), (1.0, 2.0, 3.0)) == (1.0, 2.0, 7.0)
