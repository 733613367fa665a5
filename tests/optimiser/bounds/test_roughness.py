"""Roughness that a feed leaves, and the feed that it allows."""

from dataclasses import replace
from math import sqrt

import pytest
from hypothesis import given
from hypothesis import strategies as st

from optimiser.bounds import loads
from optimiser.bounds.limits import (
    drill_point,
    force_factor,
    limits_of,
)
from optimiser.bounds.roughness import roughness_limit, roughness_load, surface_limits
from optimiser.cuts.cut import Texture
from optimiser.solver.problem import LimitName
from simulator.physics.surface import RA_FLOOR
from simulator.spec import ToolKind
from tests.optimiser.sample_cuts import (
    CARBIDE,
    CUT,
    DRILLED,
    MILL,
    TURNED,
    conditions,
    named,
    names,
)


@pytest.mark.parametrize(
    ("machine", "edge", "expected"),
    [(2.0, 26.0, 2.0), (None, 4.0, 4.0), (None, None, 24.0)],
)
def test_least_bound_of_the_depth_holds(
    machine: float | None, edge: float | None, expected: float
) -> None:
    """Machine, cutting edge, or twice the diameter by the grade."""
    at = replace(CARBIDE, machine=replace(CARBIDE.machine, max_axial_depth=machine))
    limit = named(limits_of(replace(CUT, depth_bound=edge), at), LimitName.AXIAL_DEPTH)
    assert limit.bound == pytest.approx(expected)


def test_depth_of_a_hole_is_no_depth_of_cut() -> None:
    limits = limits_of(DRILLED, conditions(ToolKind.DRILL))
    assert LimitName.AXIAL_DEPTH not in names(limits)


def test_cutting_force_of_a_drill_is_its_thrust() -> None:
    """The force along the axis is what the machine has to push with."""
    at = conditions(ToolKind.DRILL)
    limit = named(limits_of(DRILLED, at), LimitName.CUTTING_FORCE)
    assert limit.bound == 8000.0
    point = drill_point(at)
    assert point.chisel_ratio == 0.1
    assert limit.load == loads.thrust(DRILLED, at.material.kienzle, force_factor(at), point)


def test_feed_mechanism_is_teeth_times_speed_times_feed() -> None:
    limit = named(limits_of(CUT, CARBIDE), LimitName.FEED_MECHANISM)
    assert limit.load.value(0.1, 3.0, 60.0) == pytest.approx(0.1 * 4 * 60.0)
    assert limit.bound * limit.scale == pytest.approx(20_000.0)


@pytest.mark.parametrize("teeth", [1, 5])
def test_face_milled_floor_is_marked_once_a_revolution(teeth: int) -> None:
    """f²/(18√3·r) with f = z·f_z, and 0.2 µm that no feed removes."""
    cut = replace(
        CUT,
        tool=replace(MILL, teeth=teeth),
        texture=Texture.CORNER_PER_REVOLUTION,
        corner_radius=0.8,
    )
    load = roughness_load(cut)
    assert load is not None
    expected = (teeth * 0.1) ** 2 / (18.0 * sqrt(3.0) * 0.8) + 0.2e-3
    assert load.value(0.1, 3.0, 60.0) == pytest.approx(expected)


def test_end_milled_floor_is_marked_by_every_tooth() -> None:
    cut = replace(CUT, texture=Texture.CORNER_PER_TOOTH, corner_radius=0.5)
    load = roughness_load(cut)
    assert load is not None
    expected = 0.1**2 / (18.0 * sqrt(3.0) * 0.5) + 0.2e-3
    assert load.value(0.1, 3.0, 60.0) == pytest.approx(expected)


def test_wall_is_marked_by_the_circle_of_the_mill() -> None:
    """f_z²/(4·D) from peak to valley, a quarter of it as Ra."""
    load = roughness_load(replace(CUT, texture=Texture.WALL))
    assert load is not None
    expected = 0.1**2 / (4.0 * 12.0) / 4.0 + 0.2e-3
    assert load.value(0.1, 3.0, 60.0) == pytest.approx(expected)


def test_surface_that_the_feed_does_not_describe_has_no_roughness() -> None:
    assert roughness_load(CUT) is None
    at = replace(CARBIDE, roughness=1.6e-3)
    assert LimitName.ROUGHNESS not in names(limits_of(CUT, at))


def test_turned_roughness_of_print_allows_the_feed_of_print() -> None:
    """Ra 1.6 µm and a nose of 0.8 mm: 0.1998 mm without the floor of 0.2 µm."""
    limit = roughness_limit(TURNED, 1.6e-3 + 0.2e-3)
    assert limit.feed_at_bound(1.0, 10.0) == pytest.approx(0.1998, abs=5e-5)


def test_roughness_that_nobody_asks_for_does_not_limit() -> None:
    cut = replace(CUT, texture=Texture.WALL)
    assert LimitName.ROUGHNESS not in names(limits_of(cut, CARBIDE))


@given(feed=st.floats(1e-3, 1.0))
def test_a_parallel_land_is_held_to_four_fifths_of_it(feed: float) -> None:
    """Sandvik Coromant, milling surface generation."""
    cut = replace(
        CUT, texture=Texture.CORNER_PER_REVOLUTION, corner_radius=0.8, parallel_land=1.4
    )
    (limit,) = surface_limits(cut, replace(CARBIDE, roughness=1.6e-3))
    assert limit.name is LimitName.ROUGHNESS
    assert limit.holds(feed, 1.0, 1.0) is (cut.tool.teeth * feed <= 0.8 * 1.4 * (1.0 + 1e-9))
    assert roughness_load(cut) is None


def test_finer_than_careful_milling_leaves_the_corner_counts_despite_a_land() -> None:
    cut = replace(
        CUT, texture=Texture.CORNER_PER_REVOLUTION, corner_radius=0.8, parallel_land=1.4
    )
    limit, programmed = surface_limits(cut, replace(CARBIDE, roughness=RA_FLOOR / 2.0))
    assert programmed.stands_for is LimitName.ROUGHNESS
    assert limit.unit == "µm"
    assert limit.feed_at_bound(1.0, 1.0) == 0.0


def test_a_surface_without_a_law_has_no_limit() -> None:
    with pytest.raises(ValueError, match="does not follow from the feed"):
        roughness_limit(replace(CUT, texture=Texture.NONE), 1e-3)
