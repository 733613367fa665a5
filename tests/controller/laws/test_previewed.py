"""Preview for any law."""

from dataclasses import replace
from typing import Any

import pytest

from controller.laws.fuzzy import Fuzzy
from controller.laws.law import ControlLaw, Plant, Situation
from controller.laws.log_pi import LogPI
from controller.laws.model_reference import ModelReference
from controller.laws.pi import PI
from controller.laws.previewed import PlainState, Previewed, PreviewedState
from controller.laws.self_tuning import SelfTuning
from tests.controller.trial import (
    DEPTHS,
    Run,
    Trial,
    is_restless,
    run,
    score,
    unstable,
)

LAWS: list[ControlLaw[Any]] = [PI(), LogPI(), ModelReference(), Fuzzy(), SelfTuning()]
LOOK_AHEAD = 8
every_law = pytest.mark.parametrize("law", LAWS, ids=lambda law: type(law).__name__)


def previewed(law: ControlLaw[Any], **known: Any) -> Run:
    return run(Previewed(law=law), Trial(**({"look_ahead": LOOK_AHEAD} | known)))


@every_law
@pytest.mark.parametrize("gain", [0.7, 1.0, 1.4])
@pytest.mark.parametrize("lag", [1.5, 3.0, 6.0])
def test_excess_impulse_is_far_less_for_little_feed(
    law: ControlLaw[Any], gain: float, lag: float
) -> None:
    """FEEDS, "Closed loop": 50 to 100 times less for about 5 % of the feed, at lag 3."""
    before = score(run(law, Trial(gain=gain, lag=lag)))
    after = score(previewed(law, gain=gain, lag=lag))
    assert after.excess < before.excess / (50.0 if lag <= 3.0 else 10.0)
    assert after.mean_override > 0.94 * before.mean_override


@pytest.mark.parametrize(
    ("look_ahead", "peak"), [(3, 0.21), (6, 0.12), (9, 0.07), (12, 0.04), (15, 0.02)]
)
def test_peak_is_no_more_than_in_published_trials(look_ahead: int, peak: float) -> None:
    """FEEDS, "Closed loop", look-ahead against peak."""
    assert score(previewed(LogPI(), look_ahead=look_ahead)).peak <= peak


@every_law
def test_force_settles_at_the_set_point(law: ControlLaw[Any]) -> None:
    done = previewed(law)
    assert done.error[[45, 70, 105, 145, 179]] == pytest.approx(0.0, abs=0.002)
    assert is_restless(done) is False


@every_law
@pytest.mark.parametrize("late", [-1, 1])
def test_program_may_be_wrong_by_a_revolution(law: ControlLaw[Any], late: int) -> None:
    announced = tuple(DEPTHS[min(max(row - late, 0), 179)] for row in range(180))
    assert score(previewed(law, announced=announced)).peak < 0.02


@every_law
def test_step_that_nobody_announced_is_met_as_without_preview(law: ControlLaw[Any]) -> None:
    flat = (2.0,) * 180
    before = score(run(law, Trial()))
    after = score(previewed(law, announced=flat))
    assert after.peak == pytest.approx(before.peak, abs=0.01)
    assert after.excess < 1.1 * before.excess
    assert after.mean_override > 0.94 * before.mean_override
    assert unstable(Previewed(law=law), Trial(announced=flat, look_ahead=LOOK_AHEAD)) == []


@every_law
def test_step_that_never_comes_only_costs_time(law: ControlLaw[Any]) -> None:
    flat = (2.0,) * 180
    done = previewed(law, depths=flat, announced=DEPTHS[:120] + (4.0,) * 60)
    assert score(done).peak < 0.05
    assert done.error[[105, 179]] == pytest.approx(0.0, abs=0.01)
    assert done.error[50:75].min() > -0.6
    trial = Trial(depths=flat, announced=DEPTHS, look_ahead=LOOK_AHEAD)
    assert unstable(Previewed(law=law), trial) == []


@every_law
def test_band_that_was_too_narrow_leaves_nothing_behind(law: ControlLaw[Any]) -> None:
    """At depth 0.5 the ceiling rules; the announced step to 2 is met as if it had not."""
    done = previewed(law, depths=(2.0,) * 40 + (0.5,) * 60 + (2.0,) * 40, gain=0.8)
    assert done.command[60] == 2.0
    assert done.error[100:].max() < 0.02
    assert done.error[104:] == pytest.approx(0.0, abs=0.02)


AT = Situation(force=800.0, set_point=800.0, override=0.7, actual=0.7, floor=0.1, ceiling=2.0)


@pytest.mark.parametrize(
    "unknown",
    [{"expected": 0.0, "ahead": (1000.0,)}, {"expected": 900.0, "ahead": ()}, {}],
    ids=["nothing expected", "nothing ahead", "neither"],
)
@every_law
def test_without_knowledge_the_law_is_alone(
    law: ControlLaw[Any], unknown: dict[str, Any]
) -> None:
    wrapped = Previewed(law=law)
    at = replace(AT, force=900.0, **unknown)
    state, override = wrapped.decide(wrapped.begin(0.7), at)
    assert isinstance(state, PlainState)
    _, alone = law.decide(law.begin(0.7), replace(at, expected=0.0, ahead=()))
    assert override == alone


@every_law
def test_knowledge_comes_and_goes_without_a_jump(law: ControlLaw[Any]) -> None:
    wrapped = Previewed(law=law)
    known = replace(AT, expected=1100.0, ahead=(1100.0,) * 8)
    state = wrapped.begin(0.7)
    kinds = []
    for at in (AT, known, known, AT, AT, known):
        state, override = wrapped.decide(state, at)
        kinds.append(type(state))
        assert override == pytest.approx(0.7, rel=1e-6)
    assert kinds == [
        PlainState,
        PreviewedState,
        PreviewedState,
        PlainState,
        PlainState,
        PreviewedState,
    ]


def test_feed_is_lowered_before_the_load_comes() -> None:
    """An exact program and plant: the law inside has nothing to do but wait."""
    done = run(
        Previewed(law=LogPI(), plant=Plant()), Trial(start=0.8**1.25, look_ahead=LOOK_AHEAD)
    )
    assert done.error[:50] == pytest.approx(0.0, abs=1e-6)
    assert done.command[60 - LOOK_AHEAD] < 0.5
    assert done.error[60] < 0.01
