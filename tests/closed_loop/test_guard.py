"""The promise of :mod:`controller.guard`: no law breaks the tool."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, nan, pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controller.guard import SUDDEN_RATIO, OverrideBand
from controller.signals.source import DrivePower, Source
from controller.states.loop_settings import LoopSettings
from simulator.plant.course import EngagedTeeth, NominalCourse, pattern
from simulator.plant.dynamometer import DYNAMOMETER
from simulator.plant.hidden_behaviour import HiddenChange, HiddenQuantity, HiddenTruth
from tests.closed_loop.rig import BREAKAGE, Hostile, Rig, reference, rig, step
from tests.simulator.plant.courses import EXPONENT, FEED, course

WISHES = st.one_of(
    st.just((inf,)),
    st.just((99.0,)),
    st.just((0.2,) * 5 + (9.0,) * 5),
    st.just((nan, inf, -inf, 1.2)),
    st.lists(st.floats(), min_size=1, max_size=20).map(tuple),
    st.lists(st.floats(0.0, 3.0), min_size=1, max_size=20).map(tuple),
)
"""of a hostile law, over and over"""

CYCLES = 600
"""run at most: a law that only wants the floor takes its time"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Danger:
    """A cut within the assumptions, as near to their bounds as can be."""

    teeth: int = 2
    speed: float = 50.0
    """rev/s"""
    air: int = 2
    """revolutions before the cut"""
    cut: int = 30
    """revolutions before the sudden rise"""
    gaps: bool = False
    """whether the cut is interrupted now and then"""
    load: float = 0.95
    """at override 1, of the tooth that takes most, over what the planner promises"""
    hidden: float = 1.0
    """factor on the force"""
    rapid: bool = False
    """whether the air before the cut is crossed in rapid"""
    runout: float = 0.0
    """share of the chip that the tooth that lies highest takes more"""
    lag: float = 0.06
    """s, of the feed"""
    set_point: float = 400.0
    """N"""
    sudden: float = SUDDEN_RATIO
    late: float = 0.05
    """time constant of the dynamometer over a tooth period"""
    ceiling: float = 1.2
    seed: int = 0

    @property
    def rise(self) -> float:
        """Time of the sudden rise, s."""
        return (self.air + self.cut) / self.speed

    @property
    def share(self) -> float:
        """Of the tooth that takes most in the mean, at override 1."""
        teeth = EngagedTeeth(
            number=self.teeth,
            entry_angle=0.0,
            exit_angle=pi,
            exponent=EXPONENT,
            runout=0.5 * self.runout,
        )
        return float(pattern(teeth).mean(axis=1).max())

    @property
    def path(self) -> NominalCourse:
        """The cut, with more of it behind the rise."""
        force = self.load * BREAKAGE / SUDDEN_RATIO / self.hidden / self.share
        cut = np.full(2 * self.cut, force)
        if self.gaps:
            # The feed has no time to come down between one and the next.
            cut /= self.ceiling**EXPONENT
            cut[np.arange(len(cut)) % 14 < 5] = 0.0
        cells = np.concatenate([np.zeros(2 * self.air), cut, np.full(40, cut.max())])
        can_override = np.arange(len(cells)) >= 2 * self.air * self.rapid
        path = course(cells, cell=0.5 / self.speed, can_override=can_override)
        return replace(
            path,
            teeth=np.full(len(path), self.teeth),
            spindle_speed=np.full(len(path), self.speed, dtype=np.float32),
        )

    def run(self, wishes: Sequence[float], *, source: Source | None = None) -> Rig:
        """With a law that wants this."""
        per_tooth = FEED / (self.teeth * self.speed)
        hidden = HiddenTruth(
            force_factor=self.hidden,
            eccentricity=0.5 * self.runout * per_tooth,
            servo_lag=self.lag,
            changes=(
                HiddenChange(time=self.rise, what=HiddenQuantity.DEPTH, value=self.sudden),
            ),
        )
        made = rig(
            self.path,
            hidden,
            steps=[step(reference(set_point=self.set_point))],
            law=lambda _plant: Hostile(wishes=tuple(wishes)),
            settings=LoopSettings(look_ahead=0, band=OverrideBand(ceiling=self.ceiling)),
            seed=self.seed,
            instrument=replace(DYNAMOMETER, lag=self.late / (self.teeth * self.speed)),
            source=source,
        )
        return made.run(most=CYCLES)


DANGERS = st.builds(
    Danger,
    teeth=st.sampled_from([1, 2, 3, 4, 6]),
    speed=st.sampled_from([2.0, 20.0, 50.0, 100.0, 400.0]),
    air=st.sampled_from([0, 2, 20]),
    late=st.sampled_from([0.0, 0.05, 0.1]),
    cut=st.sampled_from([3, 10, 30]),
    gaps=st.booleans(),
    rapid=st.booleans(),
    load=st.floats(0.3, 0.99),
    hidden=st.floats(0.5, 2.0),
    runout=st.sampled_from([0.0, 0.2, 0.6]),
    lag=st.sampled_from([0.005, 0.02, 0.06, 0.15]),
    set_point=st.sampled_from([200.0, 400.0, 1000.0]),
    sudden=st.floats(1.0, SUDDEN_RATIO),
    ceiling=st.sampled_from([1.0, 1.2, 2.0]),
    seed=st.integers(0, 1000),
)


@pytest.fixture(scope="module", autouse=True)
def _patterns() -> None:
    """Those of the teeth are made once; that is not the time of an example."""
    Danger().run((1.0,))


@settings(max_examples=80)
@given(DANGERS, WISHES)
def test_no_law_breaks_the_tool(danger: Danger, wishes: tuple[float, ...]) -> None:
    done = danger.run(wishes)
    assert max(done.sensor.truth) <= BREAKAGE
    assert all(0.0 <= cycle.allowed.override <= danger.ceiling for cycle in done.cycles)


NEAREST = Danger(load=0.93, cut=10, lag=0.15, ceiling=1.0)
"""to its bounds, whatever the law: half of the breakage force at an override of 1"""


def test_the_promise_is_tight() -> None:
    worst = max(NEAREST.run((99.0,)).sensor.truth)
    assert 0.9 * BREAKAGE < worst <= BREAKAGE


@pytest.mark.parametrize(
    "beyond",
    [
        replace(NEAREST, sudden=1.3 * SUDDEN_RATIO),
        replace(NEAREST, load=2.1),
        replace(NEAREST, teeth=2, runout=0.6, late=0.5, cut=30, ceiling=2.0),
    ],
    ids=["greater rise", "broken promise of the planner", "late dynamometer"],
)
def test_beyond_its_assumptions_the_promise_does_not_hold(beyond: Danger) -> None:
    assert max(beyond.run((99.0,)).sensor.truth) > BREAKAGE


def test_the_power_of_the_drive_comes_too_late_for_the_promise() -> None:
    danger = Danger(load=0.7, air=100, rapid=True, cut=4, ceiling=2.0, lag=0.005)
    assert max(danger.run((99.0,)).sensor.truth) <= BREAKAGE
    by_power = danger.run((99.0,), source=DrivePower(1.0, 60.0))
    assert max(by_power.sensor.truth) > BREAKAGE
