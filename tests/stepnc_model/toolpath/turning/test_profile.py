"""Envelopes of pieces against drawings."""

from math import inf

import pytest

from stepnc_model.toolpath.turning.profile import (
    ProfilePiece,
    RadiusProfile,
    half_circle,
    highest,
    level_line,
    lowest,
    mirrored,
)

STAIR = highest([level_line(2.0, 0.0, 5.0), level_line(5.0, 5.0, 8.0)])


def test_the_higher_of_two_crossing_lines_wins_on_each_side() -> None:
    cross = [
        ProfilePiece(start=(0.0, 0.0), end=(4.0, 4.0)),
        ProfilePiece(start=(0.0, 4.0), end=(4.0, 0.0)),
    ]
    assert [p.end for p in highest(cross).pieces] == [(2.0, 2.0), (4.0, 4.0)]
    assert lowest(cross).at(1.0) == 1.0


def test_an_arch_stands_out_of_a_level() -> None:
    profile = highest([level_line(3.0, -9.0, 9.0), half_circle((0.0, 0.0), 5.0, 1)])
    assert [p.side for p in profile.pieces] == [0, 1, 0]
    assert profile.pieces[1].low == pytest.approx(-4.0)


def test_a_wall_has_the_higher_side() -> None:
    assert STAIR.at(5.0) == 5.0
    assert STAIR.at(-1.0) == -inf


def test_walls_join_the_chain() -> None:
    assert [(p.start, p.end) for p in STAIR.chain()] == [
        ((0.0, 2.0), (5.0, 2.0)),
        ((5.0, 2.0), (5.0, 5.0)),
        ((5.0, 5.0), (8.0, 5.0)),
    ]


def test_top_sees_the_crown_of_an_arc() -> None:
    arch = RadiusProfile(pieces=(half_circle((0.0, 0.0), 5.0, 1),))
    assert arch.top(-3.0, 3.0) == 5.0
    assert arch.top(3.0, 4.0) == pytest.approx(4.0)
    assert arch.bottom(-3.0, 3.0) == pytest.approx(4.0)


def test_nothing_has_no_top() -> None:
    assert RadiusProfile().top(0.0, 1.0) == -inf


def test_levels_cut_intervals() -> None:
    assert STAIR.below(3.0) == [(0.0, 5.0)]
    assert STAIR.above(3.0) == [(5.0, 8.0)]
    assert STAIR.above(5.0) == []


def test_upside_down_the_top_is_the_bottom() -> None:
    assert mirrored(STAIR.pieces).at(6.0) == -5.0
