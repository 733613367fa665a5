"""Readings of any period lead to the same override; axes that do not obey are told."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controller.guard import OverrideReason
from controller.orders import EventKind
from simulator.plant.hidden_behaviour import HiddenChange, HiddenQuantity, HiddenTruth
from tests.closed_loop.rig import SET_POINT, Rig, rig
from tests.closed_loop.test_disturbances import cut, kinds
from tests.simulator.plant.courses import EXPONENT, SPEED, TEETH, course

TOOTH = 1.0 / (SPEED * TEETH)
"""s"""

HARDER = 1.4
SETTLED = HARDER ** (-1.0 / EXPONENT)
"""override that holds the set point"""


def run(period: float, jitter: float = 0.0, seed: int = 0) -> Rig:
    """A cut that is harder than planned, read at another period."""
    path = course(cut(SET_POINT, cells=1000))
    hidden = HiddenTruth(force_factor=HARDER, eccentricity=0.01)
    return rig(path, hidden, reading_period=period, jitter=jitter, seed=seed).run(9.0)


def settled(done: Rig) -> float:
    """Mean override of the last two seconds."""
    last = [each.reading.override for each in done.cycles if each.reading.time > 7.0]
    return float(np.mean(last))


@pytest.mark.parametrize(
    "period", [0.5 * TOOTH, 0.7 * TOOTH, 1.92 * TOOTH, 0.02, 0.033, 0.1, 0.2]
)
def test_the_override_is_the_same_at_any_period(period: float) -> None:
    """1.92 tooth periods kept the loop blind at 50 %."""
    done = run(period)
    assert settled(done) == pytest.approx(SETTLED, rel=0.03)
    late = [each.allowed.holding for each in done.cycles if each.reading.time > 2.0]
    assert OverrideReason.SILENCE not in late
    assert kinds(done)[EventKind.AVERAGED] == 1
    assert "broken teeth are not looked for" in done.told(EventKind.AVERAGED)[0].text


@settings(max_examples=8, deadline=None)
@given(
    period=st.floats(0.5 * TOOTH, 0.2),
    jitter=st.floats(0.0, 0.4),
    seed=st.integers(0, 1000),
)
def test_jitter_changes_nothing(period: float, jitter: float, seed: int) -> None:
    done = run(period, jitter, seed)
    assert settled(done) == pytest.approx(SETTLED, rel=0.04)
    assert kinds(done)[EventKind.BREAKAGE] == 0
    assert kinds(done)[EventKind.SILENCE] == 0


def test_tooth_periods_are_not_averaged() -> None:
    done = run(0.0)
    assert settled(done) == pytest.approx(SETTLED, rel=0.03)
    assert kinds(done)[EventKind.AVERAGED] == 0


def test_an_override_that_is_not_followed_is_told_within_a_second() -> None:
    locked = HiddenChange(time=3.0, what=HiddenQuantity.OVERRIDE, value=1.0)
    hidden = HiddenTruth(force_factor=1.2, changes=(locked,))
    done = rig(course(cut(SET_POINT, cells=600)), hidden).run()
    (event,) = done.told(EventKind.ASTRAY)
    assert 4.0 <= event.time <= 4.3
    assert "100 % run" in event.text
    assert done.cycles[-1].is_astray


@pytest.mark.parametrize("lag", [0.02, 0.06, 0.15])
def test_axes_that_lag_are_not_taken_for_disobedient(lag: float) -> None:
    jump = HiddenChange(time=3.0, what=HiddenQuantity.DEPTH, value=1.6)
    hidden = HiddenTruth(servo_lag=lag, changes=(jump,))
    done = rig(course(cut(SET_POINT, cells=600)), hidden).run()
    assert kinds(done)[EventKind.ASTRAY] == 0
