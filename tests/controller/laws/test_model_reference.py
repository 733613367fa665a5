"""Model-reference adaptive control."""

from dataclasses import replace
from math import exp, log

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller.laws.law import Plant, Situation
from controller.laws.model_reference import GAIN_BAND, ModelReference
from tests.controller.trial import Trial, run

PLANT = Plant(exponent=0.8, lag=3.0)
POLE, SENSITIVITY = exp(-1.0 / 3.0), 0.8 * (1.0 - exp(-1.0 / 3.0))
AT = Situation(force=800.0, set_point=800.0, override=1.0, actual=1.0, floor=0.1, ceiling=2.0)


def test_nominal_gain_makes_the_nominal_plant_follow_the_model() -> None:
    """``η_{k+1} = a·η + b·(−θ_1·η)`` is ``λ·η``."""
    law = ModelReference(plant=PLANT, closing=2.0)
    gain = law.begin(1.0).gain
    assert POLE - SENSITIVITY * gain == pytest.approx(exp(-0.5))


@given(load=st.floats(-1.0, 1.0), adaptation=st.floats(0.1, 1.9))
def test_error_of_the_bias_never_grows(load: float, adaptation: float) -> None:
    """One step of the projection algorithm, [1]: ``|θ_0 − θ_0*|`` falls for 0 < γ < 2.

    From rest at override 1 the load is met: the deviation is then the model's error, caused by
    c = load alone, and the bias that would have answered it is ``−c/b``.
    """
    law = ModelReference(plant=PLANT, adaptation=adaptation)
    at = replace(AT, force=800.0 * exp(load), floor=1e-9, ceiling=1e9)
    state, _ = law.decide(law.begin(1.0), at)
    best = -load / SENSITIVITY
    assert abs(state.bias - best) <= abs(best) + 1e-9
    assert state.bias == pytest.approx(0.5 * adaptation * best)


@given(st.lists(st.floats(1.0, 1e5), min_size=1, max_size=40))
def test_parameters_stay_within_their_bounds(forces: list[float]) -> None:
    law = ModelReference(plant=PLANT)
    state, override = law.begin(1.0), 1.0
    nominal = state.gain
    for force in forces:
        at = replace(AT, force=force, override=override, actual=override)
        state, override = law.decide(state, at)
        assert GAIN_BAND[0] * nominal <= state.gain <= GAIN_BAND[1] * nominal
        assert log(0.1) - 1e-9 <= state.bias <= log(2.0) + 1e-9


def test_deviations_die_out_as_the_model_says() -> None:
    """After the jump itself, with the load learned: on the way back at least as fast."""
    done = run(ModelReference(), Trial(depths=(2.0,) * 40 + (2.2,) * 30))
    away = np.abs(done.error[40:])
    assert away[6] < away[0] * exp(-6.0 / 2.0) + 0.05
    assert away[20:] == pytest.approx(0.0, abs=0.001)


@pytest.mark.parametrize("lag", [0.1, 0.7, 1.5, 3.0, 12.0])
@pytest.mark.parametrize("deviation", [-4.0, -1.0])
def test_a_force_far_below_its_set_point_raises_the_override(
    lag: float, deviation: float
) -> None:
    law = ModelReference(plant=Plant(lag=lag))
    state, override = law.begin(1.0), 1.0
    for _ in range(30):
        at = Situation(
            force=1000.0 * exp(deviation) * override**0.8,
            set_point=1000.0,
            override=override,
            actual=override,
            floor=0.2,
            ceiling=1.2,
        )
        state, override = law.decide(state, at)
    assert override == pytest.approx(1.2)
