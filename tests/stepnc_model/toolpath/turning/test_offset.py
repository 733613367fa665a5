"""Offsets against plane geometry."""

from math import pi, sqrt, tan

import pytest

from stepnc_model.toolpath.turning.offset import (
    InsertFlanks,
    cut,
    excess,
    grown,
    lowered,
    reachable,
    thickness,
)
from stepnc_model.toolpath.turning.profile import (
    ProfilePiece,
    RadiusProfile,
    half_circle,
    highest,
    level_line,
)

SHOULDER = highest([level_line(20.0, -50.0, -40.0), level_line(15.0, -40.0, 0.0)])


def test_a_nose_turns_around_an_outside_corner_and_stops_in_an_inside_one() -> None:
    centres = grown(SHOULDER, 0.8).within(-49.0, -1.0).chain()
    assert centres[0].start[1] == pytest.approx(20.8)
    arc, wall = centres[1], centres[2]
    assert (arc.centre, arc.radius, arc.side) == ((-40.0, 20.0), 0.8, 1)
    assert wall.is_upright
    assert wall.start[0] == pytest.approx(-39.2)
    assert wall.end[1] == pytest.approx(15.8)


def test_a_hollow_loses_the_radius() -> None:
    piece = ProfilePiece(
        start=(-3.0, 6.0), end=(3.0, 6.0), centre=(0.0, 10.0), side=-1, radius=5.0
    )
    bowl = highest([piece])
    assert grown(bowl, 1.0).at(0.0) == pytest.approx(6.0)


def test_a_hollow_smaller_than_the_nose_is_bridged() -> None:
    """A nose of 2 mm on the edges of a half circle of 1 mm: its centre √3 above them."""
    hollow = highest([
        level_line(5.0, -9.0, -1.0),
        half_circle((0.0, 5.0), 1.0, -1),
        level_line(5.0, 1.0, 9.0),
    ])
    assert grown(hollow, 2.0).at(0.0) == pytest.approx(5.0 + sqrt(3.0))


def test_no_radius_changes_nothing() -> None:
    assert grown(SHOULDER, 0.0) is SHOULDER


def test_a_nose_leaves_its_radius_in_a_corner() -> None:
    bar = RadiusProfile(pieces=(level_line(30.0, -50.0, 0.0),))
    chain = grown(SHOULDER, 0.8).within(-50.0, 0.0).chain()
    left = cut(bar, chain, 0.8)
    assert left.at(-20.0) == pytest.approx(15.0)
    assert left.at(-45.0) == pytest.approx(20.0)
    assert left.at(-39.6) == pytest.approx(15.8 - sqrt(0.8**2 - 0.4**2))


def test_what_lies_above_a_surface_goes() -> None:
    bar = RadiusProfile(pieces=(level_line(18.0, -60.0, 2.0),))
    left = lowered(bar, SHOULDER)
    assert [left.at(z) for z in (-55.0, -45.0, -20.0, 1.0)] == [18.0, 18.0, 15.0, 18.0]


def test_an_edge_leaves_a_ramp_behind_a_shoulder() -> None:
    collar = highest([level_line(20.0, -10.0, 0.0), level_line(15.0, -50.0, -10.0)])
    reached = reachable(collar, InsertFlanks(behind=pi / 6.0))
    assert reached.at(-12.0) == pytest.approx(20.0 - 2.0 * tan(pi / 6.0))
    assert reached.at(-40.0) == 15.0
    assert excess(reached, collar.pieces) == pytest.approx(5.0, abs=1.5)


def test_upright_edges_reach_everything() -> None:
    assert reachable(SHOULDER, InsertFlanks()) is SHOULDER


def test_thickness_is_the_distance_out_to_the_stock() -> None:
    bar = RadiusProfile(pieces=(level_line(21.0, -50.0, 0.0),))
    assert thickness(bar, SHOULDER) == pytest.approx(6.0)
