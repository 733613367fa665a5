"""A broken tooth is found, and nothing else is taken for one."""

from collections.abc import Iterator
from dataclasses import replace
from math import acos, nan, pi
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controller.monitoring.breakage import Breakage, inspected
from tests.controller.cutter import EXPONENT, FEED_PER_TOOTH, SAMPLES, Cutter, noisy, shown
from tests.controller.shown import REVOLUTION


def learnt(cutter: Cutter, random: np.random.Generator, *, count: int = 12) -> Breakage:
    state = Breakage()
    for _ in range(count):
        state = inspected(state, shown(noisy(cutter.forces(), random)), cutter.expected)
        assert not state.is_broken
    return state


def until_found(
    state: Breakage, cutter: Cutter, broken: int, random: np.random.Generator
) -> Iterator[int]:
    """Revolutions until a tooth is found broken, and which; nothing within ten."""
    forces = cutter.forces(broken=broken)
    for count in range(1, 11):
        state = inspected(state, shown(noisy(forces, random)), cutter.expected)
        if state.broken is not None:
            yield from (count, state.broken)
            return


THIN, SLOT, HALF = acos(1.0 - 2.0 * 0.1), pi, 0.5 * pi


@pytest.mark.parametrize(
    ("teeth", "arc"),
    [(2, THIN), (2, SLOT), (3, HALF), (3, SLOT), (4, HALF), (4, SLOT), (6, HALF), (10, THIN)],
)
@pytest.mark.parametrize("eccentricity", [0.0, 0.01])
def test_broken_tooth_is_found_in_two_revolutions(
    teeth: int, arc: float, eccentricity: float
) -> None:
    random = np.random.default_rng(11)
    cutter = Cutter(teeth=teeth, arc=arc, eccentricity=eccentricity)
    for broken in range(teeth):
        state = learnt(cutter, random)
        assert tuple(until_found(state, cutter, broken, random)) == (2, broken)


def test_one_tooth_alone_in_the_cut_takes_nothing_and_the_next_the_double() -> None:
    """The textbook's pattern, from the model that the other tests rest on."""
    whole, broken = Cutter().forces(), Cutter().forces(broken=2)
    chips = (broken.max(axis=1) / whole.max(axis=1)) ** (1.0 / EXPONENT)
    np.testing.assert_allclose(chips, [1.0, 1.0, 0.0, 2.0], atol=1e-12)


def test_one_odd_revolution_is_not_enough() -> None:
    random = np.random.default_rng(3)
    cutter = Cutter()
    state = learnt(cutter, random)
    for broken in (1, None, 2, None):
        state = inspected(state, shown(cutter.forces(broken=broken)), cutter.expected)
        assert not state.is_broken


def test_broken_tooth_stays_broken_and_is_told_with_its_numbers() -> None:
    random = np.random.default_rng(3)
    cutter = Cutter()
    state = learnt(cutter, random)
    for _ in range(2):
        state = inspected(state, shown(cutter.forces(broken=1)), cutter.expected)
    assert state.is_broken
    assert inspected(state, shown(cutter.forces()), cutter.expected).broken == 1
    assert state.reason == (
        "0.00 of the mean force in the period of tooth 2, 1.00 with intact teeth"
    )


@pytest.mark.parametrize("eccentricity", [0.0, 0.01, 0.02])
@pytest.mark.parametrize("count", [1, 2, 3])
def test_tooth_that_breaks_while_the_cutter_is_learnt_is_found(
    eccentricity: float, count: int
) -> None:
    """One whole revolution tells runout from a break."""
    random = np.random.default_rng(14)
    cutter = Cutter(eccentricity=eccentricity)
    for broken in range(4):
        state = learnt(cutter, random, count=count)
        after, found = until_found(state, cutter, broken, random)
        assert found == broken
        assert after <= 3


@settings(max_examples=12)
@given(
    seed=st.integers(0, 2**32 - 1),
    teeth=st.integers(2, 8),
    arc=st.sampled_from([THIN, HALF, 2.0, SLOT]),
    eccentricity=st.sampled_from([0.0, 0.01, 0.02, 0.03]),
)
def test_a_healthy_cutter_with_runout_is_never_broken(
    seed: int, teeth: int, arc: float, eccentricity: float
) -> None:
    """While depth jumps within revolutions and the feed follows an override up and down."""
    random = np.random.default_rng(seed)
    cutter = Cutter(teeth=teeth, arc=arc, eccentricity=eccentricity)
    state, depth, override, target = Breakage(), 1.0, 1.0, 1.0
    for _ in range(80):
        before = depth
        if random.random() < 0.1:
            depth = random.uniform(0.2, 4.0)
        if random.random() < 0.1:
            target = random.uniform(0.3, 1.5)
        override += (target - override) / 3.0
        feed = override * FEED_PER_TOOTH
        is_before = np.linspace(0.0, 1.0, teeth * SAMPLES) < random.random()
        depths = np.where(is_before, before, depth).reshape(teeth, SAMPLES)
        forces = noisy(depths * cutter.forces(feed), random)
        state = inspected(state, shown(forces, feed=feed), cutter.expected)
        assert not state.is_broken


@pytest.mark.parametrize("revolutions", [1, 2, 3, 5, 10, 30])
@pytest.mark.parametrize("teeth", [2, 4, 8])
def test_force_that_grows_on_entry_is_no_broken_tooth(revolutions: int, teeth: int) -> None:
    """A ramp makes late teeth take more than early ones, in every revolution of it."""
    cutter = Cutter(teeth=teeth, arc=THIN)
    state = learnt(cutter, np.random.default_rng(5))
    ramp = (np.arange(60 * teeth) / (revolutions * teeth)).clip(max=1.0)
    for depths in (ramp, 1.0 - 0.9 * ramp, 0.1 + 0.9 * ramp):
        for each in depths.reshape(60, teeth, 1):
            state = inspected(state, shown(each * cutter.forces()), cutter.expected)
            assert not state.is_broken


def test_runout_of_the_size_of_the_feed_still_lets_a_high_tooth_be_seen() -> None:
    random = np.random.default_rng(8)
    cutter = Cutter(eccentricity=0.03)
    _, found = until_found(learnt(cutter, random), cutter, 0, random)
    assert found == 0


@pytest.mark.parametrize("teeth", [2, 3, 4, 6])
def test_low_teeth_that_leave_the_work_when_the_feed_falls_are_not_broken(teeth: int) -> None:
    """The tooth after a low one takes less then as well, since there is less left for it."""
    cutter = Cutter(teeth=teeth, arc=THIN, eccentricity=0.03)
    override, state = 1.3, Breakage()
    for row in range(60):
        override += ((1.3 if row < 20 else 0.4) - override) / 3.0
        feed = override * FEED_PER_TOOTH
        state = inspected(state, shown(cutter.forces(feed), feed=feed), cutter.expected)
        assert not state.is_broken


@pytest.mark.parametrize("teeth", [4, 8])
def test_insert_that_has_come_out_is_not_broken(teeth: int) -> None:
    """It takes more and the next one less: the order of a broken tooth, turned round."""
    chips = np.ones((teeth, 1))
    expected = Cutter(teeth=teeth, arc=THIN).expected
    state = Breakage()
    for row in range(20):
        chips[[1, 2], 0] = (1.0, 1.0) if row < 12 else (1.5, 0.5)
        forces = 400.0 * chips**EXPONENT * np.ones(SAMPLES)
        state = inspected(state, shown(forces), expected)
        assert not state.is_broken


def test_feed_may_change_before_the_tooth_breaks() -> None:
    """Offsets are learnt in mm: at half of the feed they shift chips twice as far."""
    random = np.random.default_rng(9)
    cutter = Cutter(eccentricity=0.015)
    state = learnt(cutter, random)
    feed = 0.5 * FEED_PER_TOOTH
    for broken, count in ((None, 3), (1, 2)):
        for _ in range(count):
            assert not state.is_broken
            forces = noisy(cutter.forces(feed, broken=broken), random)
            state = inspected(state, shown(forces, feed=feed), cutter.expected)
    assert state.broken == 1


def test_engagement_may_change_before_the_tooth_breaks() -> None:
    """So may the arc: what is learnt in a thin cut holds in a slot."""
    random = np.random.default_rng(15)
    thin, slot = Cutter(eccentricity=0.02, arc=1.0), Cutter(eccentricity=0.02, arc=SLOT)
    state = learnt(thin, random)
    for _ in range(3):
        state = inspected(state, shown(noisy(slot.forces(), random)), slot.expected)
        assert not state.is_broken
    assert tuple(until_found(state, slot, 2, random)) == (2, 2)


def test_air_shows_no_broken_tooth() -> None:
    random = np.random.default_rng(10)
    state = learnt(Cutter(), random)
    for _ in range(1000):
        forces = random.normal(0.5, 1.0, (4, SAMPLES))
        state = inspected(state, shown(forces), Cutter().expected)
    assert not state.is_broken


def test_single_tooth_cannot_show_it() -> None:
    state = Breakage()
    for force in [400.0] * 12 + [350.0] * 5:
        forces = np.full((1, SAMPLES), force)
        state = inspected(state, shown(forces), Cutter(teeth=1).expected)
    assert not state.is_broken
    assert state.offsets is None


def test_what_was_learnt_stays_while_nothing_is_cut_and_not_with_other_teeth() -> None:
    random = np.random.default_rng(12)
    state = learnt(Cutter(eccentricity=0.02), random).paused()
    assert state.turns == ()
    assert state.offsets is not None
    assert state.offsets.mean[0] - state.offsets.mean[2] == pytest.approx(0.04, abs=0.003)
    three = Cutter(teeth=3)
    other = inspected(state, shown(three.forces()), three.expected)
    assert other.offsets is not None
    assert len(other.offsets.mean) == 3


@pytest.mark.parametrize(
    "lacking",
    [
        {"force": nan},
        {"force": 0.0},
        {"tooth_feeds": np.zeros(4)},
        {"samples": 1},
        {"tooth_means": np.array([nan, 400.0, 400.0, 400.0])},
        {"tooth_means": np.full(4, -1.0)},
    ],
    ids=["no mean", "no force", "no feed", "one sample", "a tooth lost", "below zero"],
)
def test_revolution_that_lacks_something_is_not_judged(lacking: dict[str, Any]) -> None:
    state = learnt(Cutter(), np.random.default_rng(13))
    revolution = shown(Cutter().forces(broken=1))._replace(**lacking)
    after = inspected(state, revolution, Cutter().expected)
    assert after.turns == ()
    assert after.offsets is state.offsets


def test_without_an_arc_nothing_is_judged() -> None:
    state = inspected(Breakage(), shown(Cutter().forces()), None)
    assert state.offsets is None
    nowhere = replace(Cutter(), arc=0.0).expected
    assert inspected(state, shown(Cutter().forces()), nowhere).offsets is None


@pytest.mark.parametrize("exponent", [0.0, 1.1, nan])
def test_exponent_out_of_range_is_refused(exponent: float) -> None:
    with pytest.raises(ValueError, match="must be above 0 and at most 1"):
        inspected(Breakage(), REVOLUTION, None, exponent=exponent)
