"""Self-tuning control."""

import numpy as np
import pytest

from controller.laws.law import Plant
from controller.laws.log_pi import LogPI
from controller.laws.self_tuning import EXPONENT_BAND, SelfTuning, SelfTuningState
from tests.controller.trial import SET_POINT, TAIL, Run, Trial, run


def last_state(law: SelfTuning, done: Run) -> SelfTuningState:
    state = law.begin(done.trial.start)
    for at in done.situations:
        state, _ = law.decide(state, at)
    return state


@pytest.mark.parametrize("believed", [0.7, 0.9])
def test_exponent_of_the_material_is_learned(believed: float) -> None:
    law = SelfTuning(plant=Plant(exponent=believed))
    load = last_state(law, run(law, Trial())).load
    assert load is not None
    assert load.exponent == pytest.approx(0.8, abs=0.02)
    # What is cut at last: 1 mm at 500 N.
    assert np.exp(load.log) == pytest.approx(500.0, rel=0.02)


def test_exponent_stays_within_its_band() -> None:
    law = SelfTuning(plant=Plant(exponent=0.4))
    load = last_state(law, run(law, Trial())).load
    assert load is not None
    assert load.exponent == pytest.approx(0.4 * EXPONENT_BAND[1])


def test_noise_moves_the_feed_less_than_under_log_pi() -> None:
    noisy = Trial(noise=0.03)
    calm, quick = run(SelfTuning(), noisy), run(LogPI(), noisy)
    assert calm.force[-TAIL:].std() < 0.85 * quick.force[-TAIL:].std()


def test_slow_wear_is_followed() -> None:
    done = run(SelfTuning(), Trial(worn=1.3))
    assert done.force[59] == pytest.approx(SET_POINT, rel=0.02)
    assert done.force[-1] == pytest.approx(SET_POINT, rel=0.02)
