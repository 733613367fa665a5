"""Laws that hold for every cut."""

from dataclasses import replace
from itertools import accumulate
from math import pi, sin
from operator import mul

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.physics import (
    cutting,
    drilling,
    edge,
    engagement,
    kinematics,
    milling,
    spindle,
    tool_life,
)
from simulator.physics import cutting as power
from simulator.physics.drilling import DrillingCut
from simulator.physics.engagement import Engagement
from simulator.physics.flutes import CuttingEdges, ForceLaw
from simulator.physics.milling import MillingCut
from simulator.physics.tooth_forces import one_place, peak_resultant, wall_force
from simulator.spec import Kienzle, LinearEdge, Spindle, SpindlePoint, Taylor
from tests.oracles import cutting as oracle

diameters = st.floats(1.0, 250.0)
shares = st.floats(1e-3, 1.0)
feeds = st.floats(1e-3, 2.0)
depths = st.floats(0.01, 30.0)
teeth_numbers = st.integers(1, 20)
edge_angles = st.floats(0.1, pi / 2.0)
speeds = st.floats(0.5, 500.0)
kienzles = st.builds(Kienzle, k_c11=st.floats(100.0, 5000.0), m_c=st.floats(0.0, 0.5))


@st.composite
def engagements(draw: st.DrawFn) -> Engagement:
    diameter = draw(diameters)
    width = draw(shares) * diameter
    offset = draw(st.floats(-1.0, 1.0)) * 0.5 * (diameter - width)
    return engagement.bilateral(width, diameter, offset=offset)


cuts = st.builds(
    MillingCut,
    feed_per_tooth=feeds,
    teeth=teeth_numbers,
    axial_depth=depths,
    engagement=engagements(),
    cutting_edge_angle=edge_angles,
)


@given(diameter=diameters, share=shares)
def test_cosine_difference_is_twice_the_immersion_for_each_side(
    diameter: float, share: float
) -> None:
    width = share * diameter
    for arc in (
        engagement.unidirectional(width, diameter),
        engagement.conventional(width, diameter),
        engagement.bilateral(width, diameter),
    ):
        assert arc.cosine_difference == pytest.approx(2.0 * width / diameter, rel=1e-9)


@given(arc=engagements())
def test_cosine_difference_lies_between_0_and_2(arc: Engagement) -> None:
    assert 0.0 < arc.cosine_difference <= 2.0


@given(feed=feeds, arc=engagements(), kappa=edge_angles)
def test_mean_chip_is_at_most_the_thickest_and_that_at_most_the_feed(
    feed: float, arc: Engagement, kappa: float
) -> None:
    mean = engagement.mean_chip_thickness(feed, arc, cutting_edge_angle=kappa)
    greatest = feed * sin(kappa) * arc.greatest_sine
    assert 0.0 < mean <= greatest * (1.0 + 1e-9)
    assert greatest <= feed


@given(kienzle=kienzles, thickness=feeds, width=depths, more=st.floats(1.001, 10.0))
def test_force_rises_with_the_chip_s_area(
    kienzle: Kienzle, thickness: float, width: float, more: float
) -> None:
    force = cutting.chip_force(kienzle, chip_thickness=thickness, chip_width=width)
    thicker = cutting.chip_force(kienzle, chip_thickness=more * thickness, chip_width=width)
    wider = cutting.chip_force(kienzle, chip_thickness=thickness, chip_width=more * width)
    assert force < thicker <= wider * (1.0 + 1e-12)


@given(kienzle=kienzles, cut=cuts, more=st.floats(1.01, 10.0))
def test_milling_force_rises_with_the_feed(
    kienzle: Kienzle, cut: MillingCut, more: float
) -> None:
    faster = MillingCut(
        feed_per_tooth=more * cut.feed_per_tooth,
        teeth=cut.teeth,
        axial_depth=cut.axial_depth,
        engagement=cut.engagement,
        cutting_edge_angle=cut.cutting_edge_angle,
    )
    ratio = milling.mean_force(kienzle, faster) / milling.mean_force(kienzle, cut)
    assert ratio == pytest.approx(more ** (1.0 - kienzle.m_c))


@given(kienzle=kienzles, cut=cuts, diameter=diameters, spindle_speed=speeds)
def test_mean_force_times_speed_is_specific_force_times_removal_rate(
    kienzle: Kienzle, cut: MillingCut, diameter: float, spindle_speed: float
) -> None:
    by_force = power.cutting_power(
        milling.mean_force(kienzle, cut), kinematics.cutting_speed(diameter, spindle_speed)
    )
    rate = kinematics.milling_removal_rate(
        kinematics.feed(cut.feed_per_tooth, spindle_speed, teeth=cut.teeth),
        axial_depth=cut.axial_depth,
        radial_width=0.5 * diameter * cut.engagement.cosine_difference,
    )
    by_volume = oracle.removal_power(milling.mean_specific_force(kienzle, cut), rate)
    assert by_force == pytest.approx(by_volume)


@given(kienzle=kienzles, cut=cuts, helix=st.floats(0.0, 1.2), diameter=diameters)
def test_peak_of_a_helix_lies_below_the_chips_of_all_teeth_in_cut(
    kienzle: Kienzle, cut: MillingCut, helix: float, diameter: float
) -> None:
    """Straight edges reach one tooth's force, and a helix never all of those on its arc."""
    law = ForceLaw(exponent=1.0 - kienzle.m_c)
    arc = cut.engagement
    at = one_place(arc.entry_angle, arc.exit_angle, axial_depth=cut.axial_depth)
    edges = CuttingEdges(
        teeth=cut.teeth,
        diameter=diameter,
        helix_angle=helix,
        cutting_edge_angle=cut.cutting_edge_angle,
    )
    scale = kienzle.k_c11 * cut.feed_per_tooth**law.exponent
    sine = sin(cut.cutting_edge_angle)
    tooth = cutting.chip_force(
        kienzle,
        chip_thickness=cut.feed_per_tooth * sine * arc.greatest_sine,
        chip_width=cut.axial_depth / sine,
    )
    most = tooth * (1.0 + law.radial_share**2) ** 0.5 * (1.0 + 1e-6)
    lag = edges.lag * cut.axial_depth
    together = (arc.contact_angle + lag) / edges.pitch + 1.0
    assert scale * peak_resultant(edges, at, law)[0] <= together * most
    straight = scale * peak_resultant(replace(edges, helix_angle=0.0), at, law)[0]
    # Several teeth pull against each other, but a tooth by itself gives all it has.
    if arc.contact_angle < edges.pitch:
        # The peak is looked for at some rotations, and may lie between two of them.
        assert straight >= tooth * (1.0 - 4e-3)
    assert wall_force(edges, at, law)[0] <= peak_resultant(edges, at, law)[0] * 1.01 + 1e-9


@given(cut=cuts, k_tc=st.floats(100.0, 4000.0), k_te=st.floats(0.0, 100.0))
def test_linear_edge_force_has_the_shearing_share_of_a_constant_specific_force(
    cut: MillingCut, k_tc: float, k_te: float
) -> None:
    force = oracle.edge_mean_force(LinearEdge(k_tc=k_tc, k_te=k_te), cut)
    sheared = milling.mean_force(Kienzle(k_c11=k_tc, m_c=0.0), cut)
    assert force >= sheared * (1.0 - 1e-12)


@given(kienzle=kienzles, diameter=diameters, share=st.floats(0.0, 0.99), feed=feeds)
def test_boring_never_needs_more_torque_than_drilling(
    kienzle: Kienzle, diameter: float, share: float, feed: float
) -> None:
    solid = DrillingCut(feed_per_revolution=feed, tool_diameter=diameter)
    ring = DrillingCut(
        feed_per_revolution=feed, tool_diameter=diameter, previous_diameter=share * diameter
    )
    assert drilling.drilling_torque(kienzle, ring) <= drilling.drilling_torque(kienzle, solid)


@given(diameter=diameters, spindle_speed=speeds, feed=feeds, teeth=teeth_numbers)
def test_speeds_and_feeds_round_trip(
    diameter: float, spindle_speed: float, feed: float, teeth: int
) -> None:
    v_c = kinematics.cutting_speed(diameter, spindle_speed)
    assert kinematics.spindle_speed(diameter, v_c) == pytest.approx(spindle_speed)
    v_f = kinematics.feed(feed, spindle_speed, teeth=teeth)
    assert kinematics.feed_per_tooth(v_f, spindle_speed, teeth=teeth) == pytest.approx(feed)


@given(radius=st.floats(0.0, 20.0), depth=depths, kappa=st.floats(0.2, 1.8))
def test_rounded_edge_never_stands_steeper_than_its_straight_part(
    radius: float, depth: float, kappa: float
) -> None:
    angle = edge.effective_edge_angle(radius, depth, cutting_edge_angle=kappa)
    assert 0.0 < angle <= min(kappa, pi / 2.0) + 1e-7


@given(n=st.floats(0.08, 0.7), c=st.floats(100.0, 20_000.0), life=st.floats(10.0, 10_000.0))
def test_speed_and_life_round_trip(n: float, c: float, life: float) -> None:
    taylor = Taylor(exponent=n, constant=c)
    speed = tool_life.speed_for_life(taylor, life)
    assert tool_life.tool_life(taylor, speed) == pytest.approx(life, rel=1e-6)


@st.composite
def spindles(draw: st.DrawFn) -> Spindle:
    steps = draw(st.lists(st.floats(1.25, 4.0), min_size=1, max_size=5))
    has_torque = draw(st.booleans())
    curve = tuple(
        SpindlePoint(
            speed=speed,
            power=draw(st.floats(100.0, 50_000.0)),
            torque=draw(st.floats(100.0, 500_000.0)) if has_torque else None,
        )
        for speed in accumulate(steps, mul)
    )
    return Spindle(
        curve=curve, efficiency=0.9, min_speed=None, max_speed=None, acceleration=None
    )


@given(machine=spindles(), speed=speeds)
def test_segments_are_the_curve(machine: Spindle, speed: float) -> None:
    part = next(p for p in spindle.curve_segments(machine) if p.max_speed >= speed)
    assert part.power(speed) == pytest.approx(spindle.available_power(machine, speed))
    for point in machine.curve:
        found = spindle.available_power(machine, point.speed)
        assert found == pytest.approx(point.power, rel=1e-6)
