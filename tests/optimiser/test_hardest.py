"""Places where a tool cuts hardest, from stations made by hand."""

from collections.abc import Sequence
from dataclasses import replace
from math import acos, pi

import numpy as np
import pytest

from optimiser.cut import Cut, CutKind
from optimiser.hardest import Met, greatest_section, lengths, weighted_volume, with_hardest
from optimiser.problem import Setting
from simulator.physics.engagement import full_immersion, unidirectional
from simulator.removal.stations import CutKind as StationKind
from simulator.removal.stations import Stations
from simulator.spec import Kienzle, ToolKind
from stepnc_model.tool import Tool

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
) -> Met:
    """Stations of section, depth, entry and exit, one after another on one segment."""
    section, depth, entry, leave = np.array(rows).T
    count = len(section)
    width = np.divide(section, depth, out=np.zeros(count), where=depth > 0.0)
    stations = Stations(
        segment=np.zeros(count, dtype=np.int64),
        station=stretch * np.arange(1.0, count + 1.0),
        kind=np.where(section > 0.0, int(kind), int(StationKind.AIR)),
        section=section,
        axial_depth=depth,
        radial_width=width,
        entry_angle=entry,
        exit_angle=leave,
        contact_angle=leave - entry,
        chip_ratio=np.full(count, 0.5),
        diameter=np.full(count, diameter),
    )
    return Met(stations=stations, length=lengths(stations), cell=0.1)


def hardest(cut: Cut, *rows: tuple[float, float, float, float]) -> Cut:
    return with_hardest(cut, met(rows), STEEL, depth=4.0)


def test_stretches_begin_anew_with_each_segment() -> None:
    stations = met([(1.0, 1.0, 0.0, pi)] * 4).stations
    both = replace(stations, segment=np.array([0, 0, 1, 1]))
    assert lengths(replace(both, station=np.array([1.0, 3.0, 0.5, 2.0]))).tolist() == [
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


def test_a_sliver_of_floor_does_not_widen_the_arc() -> None:
    """0.3 mm of wall, 4 mm deep, over a floor of 10 µm at full width."""
    section = 0.3 * 4.0 + 0.01 * 10.0
    cut = hardest(FINISH, (section, 4.0, 0.0, pi))
    assert cut.engagement == unidirectional(round(section, 3) / 4.0, 10.0)


def test_a_sliver_on_the_wall_does_not_deepen_the_pass() -> None:
    """A slot 4 mm deep beside a web of 20 µm that stands 12 mm high."""
    cut = hardest(MILL, (4.0 * 10.0 + 0.02 * 8.0, 12.0, 0.0, pi))
    assert cut.engagement == full_immersion()
    assert cut.depth_share == pytest.approx(1.0, abs=0.01)


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
    assert cut.bending is not None
    assert cut.bending.depth_share == pytest.approx(1.0)


def test_only_end_mills_bend() -> None:
    face = replace(MILL, tool_kind=ToolKind.FACEMILL)
    assert hardest(face, (40.0, 4.0, 0.0, pi)).bending is None


def test_air_leaves_the_cut_as_it_was() -> None:
    assert hardest(MILL, (0.0, 0.0, 0.0, 0.0)) == MILL


def test_stretches_shorter_than_a_cell_are_noise_unless_there_are_no_others() -> None:
    long, short = met([(20.0, 4.0, 0.0, pi)]), met([(40.0, 4.0, 0.0, pi)], stretch=0.05)
    both = Met(
        stations=replace(
            met([(20.0, 4.0, 0.0, pi), (40.0, 4.0, 0.0, pi)]).stations,
            station=np.array([2.0, 2.05]),
        ),
        length=np.concatenate((long.length, short.length)),
        cell=0.1,
    )
    assert with_hardest(MILL, both, STEEL, depth=4.0).radial_width == pytest.approx(5.0)
    assert with_hardest(MILL, short, STEEL, depth=4.0).radial_width == pytest.approx(10.0)


DRILL = replace(
    MILL,
    kind=CutKind.DRILLING,
    tool=Tool(id="drill", keyword="TWIST_DRILL", diameter=10.0, teeth=2),
    tool_kind=ToolKind.DRILL,
    is_depth_free=False,
    engagement=None,
)


def test_a_hole_that_is_there_already_is_found() -> None:
    rows = [(0.25 * pi * (100.0 - 64.0), 1.0, 0.0, 0.0)]
    found = with_hardest(DRILL, met(rows, kind=StationKind.DRILLING), STEEL, depth=4.0)
    assert found.previous_diameter == pytest.approx(8.0)


def test_a_hole_that_is_said_is_kept_where_the_map_agrees() -> None:
    said = replace(DRILL, previous_diameter=9.8)
    rows = [(0.25 * pi * (100.0 - 9.8**2) + 0.4, 0.1, 0.0, 0.0)]
    assert with_hardest(said, met(rows, kind=StationKind.DRILLING), STEEL, depth=4.0) == said


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
    assert greatest_section(found, depth=4.0) == pytest.approx((pi * 50.0 * 3.0, 1.0))


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
