"""Places where a tool cuts hardest, from stations made by hand."""

from collections.abc import Sequence
from dataclasses import replace
from math import acos, cos, pi, sin

import numpy as np
import pytest

from optimiser.cuts.cut import Cut, CutKind
from optimiser.cuts.hardest_places import (
    PathContacts,
    bending,
    greatest_section,
    weighted_volume,
)
from optimiser.cuts.hardest_places import with_hardest as with_hardest_and_bent
from optimiser.solver.problem import Setting
from simulator.physics.engagement import full_immersion
from simulator.removal.stations import StationKind, Stations, stretch_lengths
from simulator.spec import Kienzle, ToolKind
from stepnc_model.programs.tool import Tool

STEEL = Kienzle(k_c11=1500.0, m_c=0.25)
MILL = Cut(
    kind=CutKind.MILLING,
    tool=Tool(id="mill", keyword="TAPERED_ENDMILL", diameter=10.0, teeth=4),
    tool_kind=ToolKind.ENDMILL,
    diameter=10.0,
    programmed=Setting(feed=0.05, depth=4.0, passes=2, speed=50.0),
    length=100.0,
    total_depth=8.0,
    is_depth_free=True,
    engagement=full_immersion(),
)
FINISH = replace(MILL, is_depth_free=False)


def met(
    rows: Sequence[tuple[float, float, float, float]],
    *,
    kind: StationKind = StationKind.MILLING,
    stretch: float = 2.0,
    diameter: float = 10.0,
    chips: Sequence[float] = (0.5,),
) -> PathContacts:
    """Stations of section, depth, entry and exit, one after another on one segment."""
    section, depth, entry, leave = np.array(rows).T
    count = len(section)
    width = np.divide(section, depth, out=np.zeros(count), where=depth > 0.0)
    stations = Stations(
        segment=np.zeros(count, dtype=np.int64),
        station=stretch * np.arange(1.0, count + 1.0),
        kind=np.where(section > 0.0, int(kind), int(StationKind.AIR)),
        section=section,
        growth=np.zeros(count),
        axial_depth=depth,
        radial_width=width,
        entry_angle=entry,
        exit_angle=leave,
        contact_angle=leave - entry,
        chip_ratio=np.resize(chips, count),
        diameter=np.full(count, diameter),
    )
    return PathContacts(stations=stations, length=stretch_lengths(stations), cell=0.1)


def with_hardest(cut: Cut, met: PathContacts, kienzle: Kienzle, *, depth: float) -> Cut:
    bent = bending(cut, met.stations, kienzle)
    return with_hardest_and_bent(cut, met, kienzle, depth=depth, bent=bent)


def hardest(
    cut: Cut, *rows: tuple[float, float, float, float], chips: Sequence[float] = (0.5,)
) -> Cut:
    return with_hardest(cut, met(rows, chips=chips), STEEL, depth=4.0)


def test_stretches_begin_anew_with_each_segment() -> None:
    stations = met([(1.0, 1.0, 0.0, pi)] * 4).stations
    both = replace(stations, segment=np.array([0, 0, 1, 1]))
    assert stretch_lengths(replace(both, station=np.array([1.0, 3.0, 0.5, 2.0]))).tolist() == [
        1.0, 2.0, 0.5, 1.5,
    ]  # fmt: skip


def test_the_first_full_cut_counts_and_not_the_many_light_ones() -> None:
    light = (8.0, 4.0, pi - acos(1.0 - 0.4), pi)
    cut = hardest(MILL, (40.0, 4.0, 0.0, pi), *[light] * 50)
    assert cut.engagement == full_immersion()
    assert cut.depth_share == 1.0
    assert cut.radial_width == pytest.approx(10.0)


def test_angles_that_agree_with_the_section_are_kept() -> None:
    """A cut in the middle of the cutter: 6 mm of 10."""
    entry = acos(0.6)
    cut = hardest(MILL, (24.0, 4.0, entry, pi - entry))
    assert cut.engagement is not None
    assert cut.engagement.entry_angle == pytest.approx(entry, abs=1e-3)
    assert cut.engagement.exit_angle == pytest.approx(pi - entry, abs=1e-3)


def test_the_mean_force_is_greatest_by_section_and_mean_chip() -> None:
    """``A·χ^(−m)``: a thinner chip of an equal section resists more, and is told as met."""
    entry = acos(0.4)
    thick, thin = (16.0, 4.0, entry, pi - entry), (16.0, 4.0, pi - acos(0.2), pi)
    cut = hardest(FINISH, thick, thin, chips=(0.9, 0.6))
    assert cut.engagement is not None
    assert cut.engagement.exit_angle == pi
    assert cut.mean_chip_ratio == 0.6
    cut = hardest(FINISH, (1.1 * 16.0, 4.4, entry, pi - entry), thin, chips=(0.9, 0.6))
    assert 1.1 * 0.9**-0.25 < 0.6**-0.25
    assert cut.mean_chip_ratio == 0.6
    cut = hardest(FINISH, (1.2 * 16.0, 4.8, entry, pi - entry), thin, chips=(0.9, 0.6))
    assert 1.2 * 0.9**-0.25 > 0.6**-0.25
    assert cut.mean_chip_ratio == 0.9


def test_a_sliver_of_floor_does_not_widen_the_arc() -> None:
    """0.3 mm of wall, 4 mm deep, over a floor of 10 µm at full width: both from the fields."""
    wall = acos(0.94)
    sines, angle = 0.01 * 2.0 + 3.99 * 0.06, 0.01 * pi + 3.99 * wall
    section = 5.0 * sines
    cut = hardest(FINISH, (section, 4.0, 0.0, pi), chips=(sines / angle,))
    assert cut.engagement is not None
    assert cut.engagement.exit_angle == pi
    assert cut.engagement.contact_angle == pytest.approx(wall, rel=0.07)
    assert cut.depth_share == pytest.approx(1.0, abs=0.04)
    assert greatest_section(cut, depth=4.0) == pytest.approx((section, sines / angle))


def test_what_an_arc_cannot_hold_in_its_depth_fills_it_more() -> None:
    """A slot 4 mm deep beside a web of 20 µm, 12 mm high, that counts for no depth."""
    section = 4.0 * 10.0 + 0.02 * 8.0
    cut = hardest(MILL, (section, 4.0, 0.0, pi), chips=(2.0 / pi,))
    assert cut.engagement == full_immersion()
    assert cut.depth_share == 1.0
    assert cut.fill == pytest.approx(1.004)
    assert cut.shank is not None
    assert cut.shank.fill == pytest.approx(1.004)
    assert greatest_section(cut, depth=4.0) == pytest.approx((section, 2.0 / pi))
    assert cut.radial_width == pytest.approx(section / 4.0)


def test_a_stock_that_really_stands_higher_deepens_the_pass() -> None:
    cut = hardest(MILL, (60.0, 6.0, 0.0, pi))
    assert cut.engagement == full_immersion()
    assert cut.depth_share == pytest.approx(1.5)


def test_less_depth_counts_only_where_no_other_may_be_chosen() -> None:
    shallow = (20.0, 2.0, 0.0, pi)
    assert hardest(MILL, shallow).depth_share == 1.0
    assert hardest(FINISH, shallow).depth_share == pytest.approx(0.5)


def test_the_shank_may_be_bent_most_elsewhere() -> None:
    """A deep narrow cut has one tooth in it, a shallow slot two: more power, less bending."""
    wide, deep = (12.0, 1.2, 0.0, pi), (10.0, 4.0, pi - acos(0.5), pi)
    cut = hardest(FINISH, wide, deep)
    assert cut.engagement == full_immersion()
    assert cut.shank is not None
    assert cut.shank.depth_share == pytest.approx(1.0)


def test_the_wall_is_spoilt_only_where_one_is_made() -> None:
    """A heavy cut in the middle of the face, and a light one along the wall."""
    entry = acos(0.8)
    middle, along = (32.0, 4.0, entry, pi - entry), (4.0, 4.0, pi - acos(0.8), pi)
    twisted = replace(FINISH, helix_angle=0.5)
    cut = hardest(twisted, middle, along)
    assert cut.shank is not None
    assert cut.wall is not None
    assert cut.shank.engagement.exit_angle == pytest.approx(pi - entry, abs=1e-3)
    assert cut.wall.engagement.exit_angle == pi


def test_an_arc_that_does_not_agree_stays_where_it_was_seen() -> None:
    """Half of what was seen at the wall that the angles reach, or about their middle."""
    walled = 1.0 - cos(1.0)
    sections = 20.0 * walled, 20.0 * walled, 20.0 * 2.0 * sin(1.75) * sin(0.5)
    chips = walled, walled, 2.0 * sin(1.75) * sin(0.5)
    hulls = (0.0, 2.0), (pi - 2.0, pi), (0.9, 2.6)
    arcs = (0.0, 1.0), (pi - 1.0, pi), (1.25, 2.25)
    for section, chip, hull, (entry, leave) in zip(sections, chips, hulls, arcs, strict=True):
        cut = hardest(FINISH, (section, 4.0, *hull), chips=(chip,))
        assert cut.engagement is not None
        assert cut.engagement.entry_angle == pytest.approx(entry, abs=1e-9)
        assert cut.engagement.exit_angle == pytest.approx(leave, abs=1e-9)
        assert cut.depth_share == pytest.approx(1.0)
        assert cut.fill == pytest.approx(1.0)


def test_only_end_mills_bend() -> None:
    face = replace(MILL, tool_kind=ToolKind.FACEMILL)
    cut = hardest(face, (40.0, 4.0, 0.0, pi))
    assert cut.shank is None
    assert cut.wall is None


def test_air_leaves_the_cut_as_it_was() -> None:
    assert hardest(MILL, (0.0, 0.0, 0.0, 0.0)) == MILL


def test_short_stretches_of_holes_are_noise_unless_there_are_no_others() -> None:
    """Milled sections are exact; what a drill or an insert meets in less than a cell is not."""
    both = drilled((8.0, 10.0), (0.0, 10.0))
    both = replace(both, length=np.array([2.0, 0.05]))
    assert with_hardest(DRILL, both, STEEL, depth=4.0).previous_diameter == pytest.approx(8.0)
    short = replace(both, length=np.full(2, 0.05))
    assert with_hardest(DRILL, short, STEEL, depth=4.0).previous_diameter == 0.0


DRILL = replace(
    MILL,
    kind=CutKind.DRILLING,
    tool=Tool(id="drill", keyword="TWIST_DRILL", diameter=10.0, teeth=2),
    tool_kind=ToolKind.DRILL,
    is_depth_free=False,
    engagement=None,
)


def drilled(*rings: tuple[float, float]) -> PathContacts:
    """Stations of a drill between inner and outer diameters."""
    inner, outer = np.array(rings).T
    rows = [
        (0.25 * pi * (o * o - i * i), 0.5 * (o - i), 0.0, 0.0)
        for i, o in zip(inner, outer, strict=True)
    ]
    found = met(rows, kind=StationKind.DRILLING)
    return replace(found, stations=replace(found.stations, diameter=0.5 * (inner + outer)))


def test_a_hole_that_is_there_already_is_found() -> None:
    found = with_hardest(DRILL, drilled((8.0, 10.0)), STEEL, depth=4.0)
    assert found.previous_diameter == pytest.approx(8.0)
    assert found.drilled_diameter == pytest.approx(10.0)


def test_a_point_that_stays_above_its_shoulder_drills_no_wider_than_it_goes_in() -> None:
    """A centre drill is a solid cut of a smaller diameter, and no ring at its rim."""
    found = with_hardest(DRILL, drilled((0.0, 3.0), (0.0, 5.5)), STEEL, depth=4.0)
    assert found.previous_diameter == 0.0
    assert found.drilled_diameter == pytest.approx(5.5)
    assert found.diameter == 10.0
    assert greatest_section(found, depth=4.0)[0] == pytest.approx(0.25 * pi * 5.5**2)


def test_turning_counts_the_deepest_place() -> None:
    turned = replace(
        FINISH,
        kind=CutKind.TURNING,
        tool=Tool(id="insert", keyword="GENERAL_TURNING_TOOL"),
        tool_kind=ToolKind.TURNING,
        diameter=50.0,
    )
    rows = [(pi * 50.0 * 2.0, 2.0, 0.0, 0.0), (pi * 48.0 * 3.0, 3.0, 0.0, 0.0)]
    found = with_hardest(turned, met(rows, kind=StationKind.TURNING), STEEL, depth=4.0)
    assert found.depth_share == pytest.approx(0.75)
    assert greatest_section(found, depth=4.0) == pytest.approx((pi * 50.0 * 3.0, 0.5))


def test_turning_is_hardest_where_the_nose_thins_the_chip() -> None:
    """``F = k_c·a·f`` of two equal depths is greater where the chip is thinner."""
    turned = replace(
        FINISH,
        kind=CutKind.TURNING,
        tool=Tool(id="insert", keyword="GENERAL_TURNING_TOOL"),
        tool_kind=ToolKind.TURNING,
    )
    rows = [(100.0, 2.0, 0.0, 0.0), (100.0, 2.0, 0.0, 0.0)]
    stations = met(rows, kind=StationKind.TURNING, chips=(1.0, 0.5))
    found = with_hardest(turned, stations, STEEL, depth=2.0)
    assert found.turning_edge_angle == pytest.approx(pi / 6.0)


def test_a_groove_is_as_wide_as_the_blade_meets() -> None:
    groove = replace(DRILL, kind=CutKind.GROOVING, radial_width=3.0, diameter=30.0)
    rows = [(pi * 30.0 * 1.5, 1.5, 0.0, 0.0)]
    found = with_hardest(groove, met(rows, kind=StationKind.TURNING), STEEL, depth=4.0)
    assert found.radial_width == pytest.approx(1.5)


def test_volume_is_section_times_way() -> None:
    rows = [(20.0, 2.0, 0.0, pi), (0.0, 0.0, 0.0, 0.0), (10.0, 2.0, 0.0, pi)]
    assert met(rows).volume == pytest.approx(60.0)
    assert weighted_volume(met(rows), 0.25) == pytest.approx(60.0 * 0.5**-0.25)


def test_section_of_a_slot_by_hand() -> None:
    """10 mm × 4 mm; the mean chip of a slot is 2/π of the feed."""
    assert greatest_section(MILL, depth=4.0) == pytest.approx((40.0, 2.0 / pi))


def test_section_of_a_milling_cut_needs_its_engagement() -> None:
    with pytest.raises(ValueError, match="engagement"):
        greatest_section(replace(MILL, engagement=None), depth=4.0)
