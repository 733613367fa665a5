"""A broken tooth is found, and nothing else is taken for one.

The forces are those of chips on the surface that earlier teeth have left, which know nothing of
shares.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import acos, nan, pi
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controller.breakage import LEARNING, Breakage, inspected
from controller.ports import Floats
from controller.signal import Revolution
from tests.controller.shown import REVOLUTION, SPINDLE_SPEED

SAMPLES = 8
EXPONENT = 0.8
FEED_PER_TOOTH = 0.1
SUNKEN = 1.0
"""mm by which a broken tooth lies below the others"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cutter:
    teeth: int = 4
    arc: float = 0.5 * pi
    """rad of down-milling that ends at π"""
    eccentricity: float = 0.0
    """mm"""
    force: float = 400.0
    """N of one tooth at its thickest chip, f_z = 0.1 mm"""

    def forces(self, feed: float = FEED_PER_TOOTH, *, broken: int | None = None) -> Floats:
        """(z, K) N."""
        turned = 2.0 * pi / self.teeth * np.arange(self.teeth)
        runout = self.eccentricity * np.cos(turned)
        if broken is not None:
            runout[broken] -= SUNKEN
        middle = (np.arange(self.teeth * SAMPLES) + 0.5) / SAMPLES
        entry = pi - self.arc
        tip = entry + 2.0 * pi / self.teeth * middle
        angle = np.mod(tip[:, None] - turned, 2.0 * pi)
        # What the tooth before left, or the one before that, is above this one's own path.
        left = [
            before * feed * np.sin(angle) + runout - np.roll(runout, before)
            for before in range(1, self.teeth + 1)
        ]
        chip = np.min(left, axis=0).clip(min=0.0)
        in_cut = (angle >= entry) & (angle <= pi)
        force = self.force * ((chip / FEED_PER_TOOTH) ** EXPONENT * in_cut).sum(axis=1)
        return np.asarray(force.reshape(self.teeth, SAMPLES))


def shown(forces: Floats, *, feed: float = FEED_PER_TOOTH, step: int = 1) -> Revolution:
    return replace(
        REVOLUTION,
        force=float(forces.mean()),
        tooth_means=forces.mean(axis=1),
        tooth_peaks=forces.max(axis=1),
        feed=feed * len(forces) * SPINDLE_SPEED,
        workingstep=step,
    )


def noisy(forces: Floats, random: np.random.Generator) -> Floats:
    """3 % of the reading and 1 N, as a dynamometer has them."""
    relative = 1.0 + 0.03 * random.standard_normal(forces.shape)
    return np.asarray(forces * relative + random.standard_normal(forces.shape))


def learnt(cutter: Cutter, random: np.random.Generator, *, count: int = 12) -> Breakage:
    state = Breakage()
    for _ in range(count):
        state = inspected(state, shown(noisy(cutter.forces(), random)))
        assert not state.is_broken
    return state


def until_found(state: Breakage, forces: Floats, random: np.random.Generator) -> Iterator[int]:
    """Revolutions until a tooth is found broken, and which; nothing within ten."""
    for count in range(1, 11):
        state = inspected(state, shown(noisy(forces, random)))
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
    """Two revolutions to confirm, and one more where the break makes the force step."""
    random = np.random.default_rng(11)
    cutter = Cutter(teeth=teeth, arc=arc, eccentricity=eccentricity)
    for broken in range(teeth):
        state = learnt(cutter, random)
        count, found = until_found(state, cutter.forces(broken=broken), random)
        assert found == broken
        assert 2 <= count <= 3


def test_one_tooth_alone_in_the_cut_takes_nothing_and_the_next_the_double() -> None:
    """The textbook's pattern, from the model that the other tests rest on."""
    whole, broken = Cutter().forces(), Cutter().forces(broken=2)
    chips = (broken.max(axis=1) / whole.max(axis=1)) ** (1.0 / EXPONENT)
    np.testing.assert_allclose(chips, [1.0, 1.0, 0.0, 2.0], atol=1e-12)


def test_one_odd_revolution_is_not_enough() -> None:
    random = np.random.default_rng(3)
    cutter = Cutter()
    state = inspected(learnt(cutter, random), shown(cutter.forces(broken=1)))
    assert (state.suspect, state.broken) == (1, None)
    state = inspected(state, shown(cutter.forces()))
    assert (state.suspect, state.broken) == (None, None)


def test_broken_tooth_stays_broken() -> None:
    random = np.random.default_rng(3)
    cutter = Cutter()
    state = learnt(cutter, random)
    for _ in range(2):
        state = inspected(state, shown(cutter.forces(broken=1)))
    assert state.is_broken
    assert inspected(state, shown(cutter.forces())).broken == 1
    assert inspected(state, shown(cutter.forces(), step=2)).broken == 1


@settings(max_examples=25)
@given(
    seed=st.integers(0, 2**32 - 1),
    teeth=st.integers(2, 8),
    arc=st.sampled_from([THIN, HALF, 2.0, SLOT]),
    eccentricity=st.sampled_from([0.0, 0.01, 0.02, 0.03]),
)
def test_whole_tool_is_never_found_broken(
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
        state = inspected(state, shown(forces, feed=feed))
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
            state = inspected(state, shown(each * cutter.forces()))
            assert not state.is_broken


def test_runout_of_the_size_of_the_feed_still_lets_a_high_tooth_be_seen() -> None:
    random = np.random.default_rng(8)
    cutter = Cutter(eccentricity=0.03)
    _, found = until_found(learnt(cutter, random), cutter.forces(broken=0), random)
    assert found == 0


@pytest.mark.parametrize("teeth", [2, 3, 4, 6])
def test_low_teeth_that_leave_the_work_when_the_feed_falls_are_not_broken(teeth: int) -> None:
    """The tooth after a low one takes less then as well, since there is less left for it."""
    cutter = Cutter(teeth=teeth, arc=THIN, eccentricity=0.03)
    override, state = 1.3, Breakage()
    for row in range(60):
        override += ((1.3 if row < 20 else 0.4) - override) / 3.0
        feed = override * FEED_PER_TOOTH
        state = inspected(state, shown(cutter.forces(feed), feed=feed))
        assert state.suspect is None


@pytest.mark.parametrize("teeth", [4, 8])
def test_insert_that_has_come_out_is_not_broken(teeth: int) -> None:
    """It takes more and the next one less: the order of a broken tooth, turned round."""
    chips = np.ones((teeth, 1))
    state = Breakage()
    for row in range(20):
        chips[[1, 2], 0] = (1.0, 1.0) if row < 12 else (1.5, 0.5)
        forces = 400.0 * chips**EXPONENT * np.ones(SAMPLES)
        state = inspected(state, shown(forces))
        assert state.suspect is None


def test_feed_may_change_before_the_tooth_breaks() -> None:
    """The pattern of runout is learnt in mm: at half of the feed it is twice as strong."""
    random = np.random.default_rng(9)
    cutter = Cutter(eccentricity=0.015)
    state = learnt(cutter, random)
    feed = 0.5 * FEED_PER_TOOTH
    # The force falls with the feed, and is judged from the second revolution on.
    for _ in range(2):
        state = inspected(state, shown(noisy(cutter.forces(feed), random), feed=feed))
    assert state.suspect is None
    for _ in range(3):
        broken = noisy(cutter.forces(feed, broken=1), random)
        state = inspected(state, shown(broken, feed=feed))
    assert state.broken == 1


def test_air_shows_no_broken_tooth() -> None:
    random = np.random.default_rng(10)
    state = learnt(Cutter(), random)
    for _ in range(3000):
        state = inspected(state, shown(random.normal(0.5, 1.0, (4, SAMPLES))))
    assert not state.is_broken


def test_single_tooth_cannot_show_it() -> None:
    state = Breakage()
    for force in [400.0] * 12 + [350.0] * 5:
        state = inspected(state, shown(np.full((1, SAMPLES), force)))
    assert not state.is_broken
    assert len(state.feeds) == 0


def test_another_workingstep_or_tool_is_learnt_anew() -> None:
    random = np.random.default_rng(12)
    state = learnt(Cutter(), random)
    assert len(state.feeds) >= LEARNING
    other = inspected(state, shown(Cutter().forces(), step=2))
    assert len(other.feeds) == 0
    assert other.workingstep == 2
    assert inspected(state, shown(Cutter(teeth=3).forces())).shares.shape == (0, 3)


@pytest.mark.parametrize(
    "lacking",
    [
        {"force": nan},
        {"force": 0.0},
        {"feed": 0.0},
        {"tooth_means": np.array([nan, 400.0, 400.0, 400.0])},
        {"tooth_means": np.full(4, -1.0)},
    ],
    ids=["no mean", "no force", "no feed", "a tooth lost", "below zero"],
)
def test_revolution_that_lacks_something_is_not_judged(lacking: dict[str, Any]) -> None:
    state = learnt(Cutter(), np.random.default_rng(13))
    revolution = replace(shown(Cutter().forces(broken=1)), **lacking)
    after = inspected(state, revolution)
    assert (after.suspect, after.broken) == (None, None)
    np.testing.assert_array_equal(after.shares, state.shares)


@pytest.mark.parametrize("exponent", [0.0, 1.1, nan])
def test_exponent_out_of_range_is_refused(exponent: float) -> None:
    with pytest.raises(ValueError, match="must be above 0 and at most 1"):
        inspected(Breakage(), REVOLUTION, exponent=exponent)
