"""Shin et al., "Developing a virtual machining model to generate MTConnect data", 2016.

Fig. 7c prints the power of the C axis every 0.2 s from the start of the spindle, with a noise
of about 2 %; §4.1: AL6061, 0.25 mm/rev, 166.5 rad/s, depth 2.5 mm. The samples at 1.4 s
and 1.6 s are left out: their digits cannot be trusted in the copy at hand.
"""

from math import pi

import pytest

from simulator.library import load_machine
from simulator.physics import spindle, turning
from simulator.spec import Kienzle
from stepnc_model.units import nm_from_nmm
from tests.oracles import spindle as oracle_spindle
from tests.oracles.motion import ramp_time

SPEED = 166.5 / (2 * pi)
RAMP = [
    (0.2, 904.82),
    (0.4, 1836.57),
    (0.6, 2708.56),
    (0.8, 3598.43),
    (1.0, 4579.11),
    (1.2, 5333.83),
]
IDLING = [535.14, 538.50, 547.85, 535.94, 526.15, 534.07, 529.91, 533.02, 547.07, 532.20]
SPINDLE = load_machine("paper000").spindle
ACCELERATION = SPINDLE.acceleration or 0.0


@pytest.mark.parametrize(("seconds", "watts"), RAMP)
def test_the_ramp_draws_what_the_figure_prints(seconds: float, watts: float) -> None:
    power = spindle.spindle_power(SPINDLE, ACCELERATION * seconds, ACCELERATION)
    assert power == pytest.approx(watts, rel=0.03)


def test_the_ramp_ends_between_the_last_high_sample_and_the_first_low_one() -> None:
    assert 1.6 < ramp_time(SPEED, ACCELERATION) < 1.8


def test_the_spindle_then_idles_at_535_watts() -> None:
    power = spindle.spindle_power(SPINDLE, SPEED)
    assert power == pytest.approx(sum(IDLING) / len(IDLING), rel=0.005)
    torque = oracle_spindle.running_torque(SPINDLE, SPEED)
    assert nm_from_nmm(torque) == pytest.approx(3.05, rel=0.005)


def test_the_cut_adds_the_power_of_its_force_without_a_2_pi() -> None:
    """4050 W in all at Ø50: F_c = 802 N; Kienzle 800/0.25 gives 707 N and 3098 W."""
    radius = 25.0
    force = (4050.0 - 535.0) * SPINDLE.efficiency * 1000.0 / (166.5 * radius)
    assert force == pytest.approx(802.0, rel=1e-3)
    cut = turning.TurningCut(feed_per_revolution=0.25, depth=2.5)
    kienzle = turning.cutting_force(Kienzle(k_c11=800.0, m_c=0.25), cut)
    assert kienzle == pytest.approx(707.0, rel=1e-3)
    cutting_power = kienzle * 166.5 * radius / 1000.0
    idle = spindle.spindle_power(SPINDLE, SPEED)
    total = spindle.spindle_power(SPINDLE, SPEED, cutting_power=cutting_power)
    assert total - idle == pytest.approx(3098.0, rel=1e-3)


def test_stopping_draws_nothing_and_returns_nothing() -> None:
    assert spindle.spindle_power(SPINDLE, SPEED, -ACCELERATION) == 0.0
