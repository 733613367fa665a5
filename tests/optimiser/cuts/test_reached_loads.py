"""What loads become where the axes are slower than the feed: stations and runs made by hand."""

from collections.abc import Sequence
from dataclasses import replace
from math import sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from optimiser.cuts.cut import CriticalPlace, Cut, CutKind, ReachedLoads
from optimiser.cuts.hardest_places import KINDS, Bending, PathContacts
from optimiser.cuts.reached_loads import MachineRun, thickened, with_reached
from simulator.motion.control import ExactStop
from simulator.motion.fir import FixedTimeFilter
from simulator.motion.passing import motion_of
from simulator.motion.segments import AxisLimits, ControlModel, Leg, Segments, lines
from simulator.motion.tool_path import ToolPathRun
from simulator.physics.engagement import full_immersion
from simulator.removal.stations import Stations, stretch_lengths
from tests.optimiser.sample_cuts import CUT, DRILLED, TURNED

FEED, SPINDLE, ACCELERATION, EXPONENT = 20.0, 25.0, 100.0, 0.25
"""mm/s, rev/s, mm/s², m_c: the feed is reached in 2 mm"""

HELD = AxisLimits(
    acceleration=np.full(3, ACCELERATION), rapid=np.full(3, 500.0), feed=np.full(3, 500.0)
)


def ride(
    path: Segments | None = None, *, feed: float = FEED, spindle: Sequence[float] = (SPINDLE,)
) -> MachineRun:
    """Along 100 mm unless another path is given, in one leg."""
    path = lines([(0, 0, 0), (100, 0, 0)], speed=FEED) if path is None else path
    run = ToolPathRun(
        moves=(),
        segments=path,
        spindle=np.resize(spindle, len(path)),
        is_clockwise=True,
        legs=(Leg(first=0, last=len(path), wait=0.0),),
    )
    motion = motion_of(run, ExactStop(), HELD)
    return MachineRun(motion=motion, feed=feed, spindle=SPINDLE)


def met(
    cut: Cut,
    *rows: tuple[float, float],
    segment: Sequence[int] = (0,),
    growth: Sequence[float] = (0.0,),
    diameter: Sequence[float] = (),
) -> PathContacts:
    """Stations by the end of their stretch in mm and the section there in mm²."""
    ends, section = np.array(rows).T
    count = len(ends)
    ones = np.ones(count)
    stations = Stations(
        segment=np.resize(segment, count),
        station=ends,
        kind=np.full(count, int(KINDS[cut.kind])),
        section=section,
        growth=np.resize(growth, count),
        axial_depth=section,
        radial_width=ones,
        entry_angle=0.0 * ones,
        exit_angle=ones,
        contact_angle=ones,
        chip_ratio=ones,
        diameter=np.resize(diameter or (cut.force_diameter,), count),
    )
    return PathContacts(stations=stations, length=stretch_lengths(stations), cell=0.1)


def bent(*walls: float) -> Bending:
    """Forces at the wall of the first stations."""
    return Bending(at=np.arange(len(walls)), shank=np.ones(len(walls)), wall=np.array(walls))


def reached(
    cut: Cut, path: PathContacts, how: MachineRun, bending: Bending | None = None
) -> Cut:
    return with_reached(cut, path, bending or bent(), how, exponent=EXPONENT)


def loads(of: Cut) -> tuple[float, float, float]:
    return of.reached.force, of.reached.power, of.reached.wall


def test_where_the_axes_keep_the_feed_all_loads_are_reached() -> None:
    found = reached(CUT, met(CUT, (40, 1), (60, 6), (100, 1)), ride(), bent(1.0, 6.0, 1.0))
    assert loads(found) == pytest.approx((1.0, 1.0, 1.0))


def test_at_the_end_of_a_move_the_chip_is_thinner_by_the_ramp() -> None:
    """The last 0.5 mm: √(2·100·0.5) = 10 of 20 mm/s at most, so 0.5^(1 − m_c) of the force."""
    found = reached(CUT, met(CUT, (99.5, 0), (100, 6)), ride(), bent(0.0, 6.0))
    share = 0.5 ** (1.0 - EXPONENT)
    assert loads(found) == pytest.approx((share, share, share), rel=1e-5)


@given(way=st.floats(0.4, 1.9), exponent=st.floats(0.1, 0.45))
def test_the_share_is_that_of_the_speed_to_its_power(way: float, exponent: float) -> None:
    """``(v/v_f)^(1 − m_c)`` with ``v = √(2as)`` where the hard stretch begins."""
    path = met(CUT, (100.0 - way, 0.0), (100.0, 6.0))
    found = with_reached(CUT, path, bent(), ride(), exponent=exponent)
    share = sqrt(2.0 * ACCELERATION * way) / FEED
    assert found.reached.force == pytest.approx(share ** (1.0 - exponent), rel=1e-5)


def test_an_easy_place_at_the_feed_counts_where_the_hardest_is_slow() -> None:
    """0.02 mm before the end a tenth of the feed is left: a section 0.3 times as large wins."""
    found = reached(CUT, met(CUT, (50, 1.8), (99.98, 0), (100, 6)), ride())
    assert 0.1 ** (1.0 - EXPONENT) < 0.3
    assert found.reached.force == pytest.approx(0.3)
    assert found.reached.power == pytest.approx(0.3)


def test_each_load_has_a_place_of_its_own() -> None:
    """The wall bends most where the axes run, the mean force is greatest where they stop."""
    found = reached(CUT, met(CUT, (50, 4), (99.5, 0), (100, 6)), ride(), bent(5.0, 0.0, 4.0))
    share = 0.5 ** (1.0 - EXPONENT)
    assert found.reached.force == pytest.approx(max(share, 4.0 / 6.0), rel=1e-5)
    assert found.reached.wall == pytest.approx(1.0)


def test_slow_axes_brake_in_the_last_micrometres() -> None:
    """A cone is met whole at its end: at 0.6 mm/s the way to brake is 2 µm."""
    slow = 0.6
    path = lines([(0, 0, 1), (0, 0, 0)], speed=slow)
    cone = met(DRILLED, (0.7, 1.0), (1.0, 6.0), growth=(0.0, 6.0))
    found = reached(DRILLED, cone, ride(path, feed=slow))
    assert loads(found)[0] > 0.98


def test_where_no_wall_bends_its_share_is_one() -> None:
    found = reached(CUT, met(CUT, (99.5, 0), (100, 6)), ride())
    assert found.reached.wall == 1.0


def test_a_section_that_falls_towards_the_end_is_greatest_at_the_feed() -> None:
    """From 8 to 4 mm² in 20 mm: the greatest lies where the stretch begins."""
    path = met(CUT, (80, 0), (100, 6), growth=(0.0, -4.0))
    assert reached(CUT, path, ride()).reached.force == pytest.approx(1.0, rel=1e-6)


def test_a_section_that_rises_to_the_end_is_greatest_on_the_way() -> None:
    """From 4 to 8 mm² in 20 mm: at seven eighths 7.5, and the feed still is reached."""
    path = met(CUT, (80, 0), (100, 6), growth=(0.0, 4.0))
    assert reached(CUT, path, ride()).reached.force == pytest.approx(7.5 / 8.0)


def test_a_segment_with_half_the_feed_takes_half_the_chip() -> None:
    path = lines([(0, 0, 0), (100, 0, 0), (0, 0, 0)], speed=FEED)
    path.speed[1] = 0.5 * FEED
    found = reached(CUT, met(CUT, (100, 0), (100, 6), segment=(0, 1)), ride(path))
    assert found.reached.force == pytest.approx(0.5 ** (1.0 - EXPONENT))


@pytest.mark.parametrize("spindle", [0.5, 2.0])
def test_the_chip_is_the_feed_per_revolution(spindle: float) -> None:
    """At the same feed a slower spindle takes a thicker chip; the power has both."""
    found = reached(CUT, met(CUT, (50, 6)), ride(spindle=(spindle * SPINDLE,)))
    chip = (1.0 / spindle) ** (1.0 - EXPONENT)
    assert found.reached.force == pytest.approx(chip)
    assert found.reached.power == pytest.approx(chip * spindle)


def test_nothing_is_told_where_nothing_is_cut_at_a_feed() -> None:
    rapid = lines([(0, 0, 0), (100, 0, 0)])
    full = met(CUT, (50, 6))
    assert reached(CUT, full, ride(rapid)) is CUT
    assert reached(CUT, full, ride(spindle=(0.0,))) is CUT
    assert reached(CUT, met(CUT, (50, 0)), ride()) is CUT
    assert reached(CUT, met(DRILLED, (50, 6)), ride()) is CUT


def test_a_turned_cut_learns_where_its_power_is_greatest() -> None:
    """Equal depths at 40 and 60 mm, the spindle as the surface speed has it: equal powers.

    A little deeper at 60 mm: the power is greatest there, at two thirds of the speed.
    """
    path = lines([(0, 0, 0), (0, 0, -50), (0, 0, -100)], speed=FEED)
    how = ride(path, spindle=(SPINDLE, SPINDLE / 1.5))
    deep = met(TURNED, (50, 2.0), (50, 2.2), segment=(0, 1), diameter=(40.0, 60.0))
    found = reached(TURNED, deep, how)
    slow, fast = found.power_places
    assert (slow.power, slow.speed) == pytest.approx((1.0, 1.0 / 1.5))
    assert (fast.power, fast.speed) == pytest.approx((2.0 / 2.2, 1.0))
    # The deeper cut at 60 mm takes the greatest torque, whatever its speed.
    assert found.torque_diameter == pytest.approx(60.0)
    # The force times this diameter, at the spindle speed of the cut.
    assert found.power_diameter == pytest.approx(60.0 / 1.5)
    assert found.reached == ReachedLoads()


DOWN = lines([(0, 0, 0), (0, 0, -100)], speed=FEED)


def test_a_spindle_that_slows_down_has_its_power_where_a_segment_begins() -> None:
    """Between the middles of segments its speed changes evenly: 21 to 20 rev/s is 20.5."""
    path = lines([(0, 0, 0), (0, 0, -50), (0, 0, -100)], speed=FEED)
    both = met(TURNED, (50.0, 1e-6), (50.0, 4.0), segment=(0, 1), diameter=(40.0, 40.0))
    even = reached(TURNED, both, ride(path, spindle=(20.0, 20.0)))
    late = reached(TURNED, both, ride(path, spindle=(21.0, 20.0)))
    assert even.power_diameter is not None
    assert late.power_diameter == pytest.approx(even.power_diameter * 20.5 / 20.0)


def test_a_drill_at_its_feed_has_the_chip_of_its_feed() -> None:
    found = reached(DRILLED, met(DRILLED, (50, 70)), ride(DOWN))
    assert found.thickest == pytest.approx(1.0)
    assert found.power_diameter == pytest.approx(DRILLED.force_diameter)
    assert loads(found) == pytest.approx((1.0, 1.0, 1.0))


@given(slow=st.floats(0.3, 0.95))
def test_a_slower_spindle_alone_thickens_the_chip_of_a_drill(slow: float) -> None:
    """At the same feed ``1/slow`` times the chip: what limits hold against is all reached."""
    found = reached(DRILLED, met(DRILLED, (50, 70)), ride(DOWN, spindle=(slow * SPINDLE,)))
    assert found.kind is CutKind.DRILLING
    assert found.thickest == pytest.approx(1.0 / slow)
    assert found.power_diameter == pytest.approx(slow * DRILLED.force_diameter)
    assert loads(found) == pytest.approx((1.0, 1.0, 1.0))


def test_a_drill_that_is_slowed_at_entry_keeps_the_chip_of_its_feed() -> None:
    path = lines([(0, 0, 0), (0, 0, -5), (0, 0, -50)], speed=FEED)
    path.speed[0] = 0.5 * FEED
    path.block[:] = 0
    found = reached(DRILLED, met(DRILLED, (5, 70), (30, 70), segment=(0, 1)), ride(path))
    assert found.thickest == pytest.approx(1.0)
    assert found.reached.force == pytest.approx(1.0)


@given(
    sections=st.lists(st.floats(0.1, 50.0), min_size=1, max_size=8),
    walls=st.lists(st.floats(0.1, 50.0), min_size=8, max_size=8),
)
def test_at_the_programmed_feed_no_share_is_above_one(
    sections: list[float], walls: list[float]
) -> None:
    count = len(sections)
    ends = np.linspace(0.0, 100.0, count + 1)[1:]
    path = met(CUT, *zip(ends.tolist(), sections, strict=True))
    found = reached(CUT, path, ride(), bent(*walls[:count]))
    assert all(0.0 < share <= 1.0 + 1e-9 for share in loads(found))


def test_a_cut_keeps_all_else() -> None:
    found = reached(CUT, met(CUT, (99.5, 0), (100, 6)), ride())
    assert replace(found, reached=ReachedLoads()) == CUT


def test_limits_bear_places_that_are_faster_than_their_feed() -> None:
    """A control that rounds a change of the feed speeds up before it: 10 % more force."""
    place = CriticalPlace(engagement=full_immersion(), depth_share=1.0, fill=0.5)
    fast = ReachedLoads(force=1.1, power=1.1, wall=1.2)
    cut = replace(CUT, shank=place, wall=place, fill=0.8, reached=fast)
    borne = thickened(cut)
    assert borne.fill == pytest.approx(0.88)
    assert borne.shank is not None
    assert borne.wall is not None
    assert (borne.shank.fill, borne.wall.fill) == pytest.approx((0.55, 0.6))
    assert borne.reached == ReachedLoads()
    slow = replace(cut, reached=ReachedLoads(force=0.9, power=0.9, wall=0.9))
    assert thickened(slow) is slow


@pytest.mark.parametrize("control", [ExactStop(), FixedTimeFilter(first=0.1, second=0.05)])
@pytest.mark.parametrize("seed", range(6))
def test_stations_that_are_not_looked_at_change_nothing(
    control: ControlModel, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    random = np.random.default_rng(seed)
    corners = random.uniform(0.0, 8.0, (40, 3)) * [1.0, 1.0, 0.1]
    path = lines(list(corners), speed=FEED)
    path.speed[20:] *= random.uniform(0.3, 1.5)
    rows = np.repeat(np.arange(len(path)), 5)
    ends = (path.length[:, None] * np.linspace(0.2, 1.0, 5)).ravel()
    section = random.uniform(0.5, 6.0, len(ends))
    walls = random.uniform(0.0, 6.0, len(ends))
    places = met(CUT, *zip(ends, section, strict=True), segment=rows.tolist())
    how = replace(ride(path), motion=motion_of(ride(path).run, control, HELD))
    found = []
    for first in (1, 16, 10_000):
        monkeypatch.setattr("optimiser.cuts.reached_loads.FIRST", first)
        found.append(loads(reached(CUT, places, how, bent(*walls))))
    assert found[0] == pytest.approx(found[2], rel=1e-12)
    assert found[1] == pytest.approx(found[2], rel=1e-12)
    assert min(found[2]) > 0.0
