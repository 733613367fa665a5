"""The control laws by name, and what all of them promise."""

import sys
from collections.abc import Sequence
from dataclasses import replace
from math import isfinite
from subprocess import run as run_program
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controller.laws.choice import LawName, law_named
from controller.laws.fuzzy import Fuzzy
from controller.laws.law import ControlLaw, Plant, Situation
from controller.laws.log_pi import LogPI
from controller.laws.model_reference import ModelReference
from controller.laws.open_loop import OpenLoop
from controller.laws.pi import PI
from controller.laws.previewed import Previewed
from controller.laws.self_tuning import SelfTuning
from tests.controller.trial import SET_POINT, Trial, run, unstable

KINDS: dict[LawName, type[Any]] = {
    LawName.PI: PI,
    LawName.LOG_PI: LogPI,
    LawName.FUZZY: Fuzzy,
    LawName.SELF_TUNING: SelfTuning,
    LawName.MRAC: ModelReference,
}
"""those that feed back, MPC apart"""

feedback = pytest.mark.parametrize("name", KINDS)
preview = pytest.mark.parametrize("has_preview", [False, True], ids=["alone", "preview"])

AT = Situation(force=800.0, set_point=800.0, override=1.0, actual=1.0, floor=0.1, ceiling=2.0)
positive = st.floats(min_value=0.0, exclude_min=True, allow_infinity=False)
not_negative = st.floats(min_value=0.0, allow_infinity=False)


@st.composite
def situations(draw: st.DrawFn) -> Situation:
    """Whatever is positive and finite, in a band of overrides."""
    floor = draw(st.floats(1e-3, 1.5))
    return Situation(
        force=draw(positive),
        set_point=draw(positive),
        override=draw(not_negative),
        actual=draw(not_negative),
        floor=floor,
        ceiling=draw(st.floats(floor, 3.0)),
        expected=draw(not_negative),
        ahead=tuple(draw(st.lists(not_negative, max_size=4))),
    )


def wanted(law: ControlLaw[Any], course: Sequence[Situation]) -> list[float]:
    state, found = law.begin(1.0), []
    for at in course:
        state, override = law.decide(state, at)
        found.append(override)
    return found


@feedback
def test_preview_wraps_the_law(name: LawName) -> None:
    plant = Plant(lag=5.0)
    assert law_named(name, plant, has_preview=False) == KINDS[name](plant=plant)
    wrapped = law_named(name, plant, has_preview=True)
    assert wrapped == Previewed(law=KINDS[name](plant=plant), plant=plant)


@preview
def test_no_law_leaves_the_override_alone(has_preview: bool) -> None:
    assert law_named(LawName.NONE, Plant(), has_preview=has_preview) == OpenLoop()


def test_mpc_has_its_own_preview() -> None:
    law = law_named(LawName.MPC, Plant(), has_preview=True)
    assert type(law).__name__ == "ModelPredictive"
    assert all(0.1 <= each <= 2.0 for each in wanted(law, [AT] * 3))


def test_solver_is_not_loaded_before_it_is_needed() -> None:
    look = "import sys, controller.laws.choice; sys.exit('osqp' in sys.modules)"
    assert run_program([sys.executable, "-c", look], check=False).returncode == 0


@feedback
@preview
@given(course=st.lists(situations(), min_size=1, max_size=6))
@settings(max_examples=50)
def test_override_is_finite_and_in_its_band(
    name: LawName, has_preview: bool, course: list[Situation]
) -> None:
    found = wanted(law_named(name, Plant(), has_preview=has_preview), course)
    for at, override in zip(course, found, strict=True):
        assert isfinite(override)
        assert at.floor <= override <= at.ceiling


@feedback
@preview
@given(override=st.floats(0.15, 1.9), depth=st.floats(1.0, 4.0))
@settings(max_examples=30)
def test_cut_begins_without_a_jump(
    name: LawName, has_preview: bool, override: float, depth: float
) -> None:
    """A force at its set point asks for nothing, whatever the program expected."""
    law = law_named(name, Plant(), has_preview=has_preview)
    expected = 500.0 * depth
    at = replace(
        AT, override=override, actual=override, expected=expected, ahead=(expected,) * 8
    )
    _, found = law.decide(law.begin(override), at)
    assert found == pytest.approx(override, rel=1e-6)


@feedback
@preview
def test_corner_that_slows_the_axes_is_not_answered(name: LawName, has_preview: bool) -> None:
    """The feed drops to a third and the force with it, but the override was right."""
    law = law_named(name, Plant(), has_preview=has_preview)
    corner = replace(AT, actual=0.3, force=800.0 * 0.3**0.8)
    course = [AT] * 3 + [corner] * 5 + [AT] * 3
    if has_preview:
        course = [replace(each, expected=800.0, ahead=(800.0,) * 8) for each in course]
    assert wanted(law, course) == pytest.approx([1.0] * 11, rel=1e-6)


@feedback
@preview
def test_nothing_winds_up_at_the_ceiling(name: LawName, has_preview: bool) -> None:
    """However long the force could not be reached: one step brings the feed down."""
    look_ahead = 8 if has_preview else 0
    left = {}
    for length in (40, 400):
        trial = Trial(depths=(0.5,) * length + (2.0,) * 30, announced=(2.0,) * (length + 30))
        trial = replace(trial, look_ahead=look_ahead)
        done = run(law_named(name, Plant(), has_preview=has_preview), trial)
        assert done.command[length - 1] == pytest.approx(2.0)
        left[length] = done.command[length:]
    assert left[400] == pytest.approx(left[40], rel=0.01)
    assert left[400][1] < 1.5


@feedback
@preview
def test_no_variant_of_the_plant_makes_it_unstable(name: LawName, has_preview: bool) -> None:
    law = law_named(name, Plant(), has_preview=has_preview)
    trial = Trial(look_ahead=8 if has_preview else 0)
    assert unstable(law, replace(trial, noise=0.03)) == []


@feedback
@preview
@pytest.mark.parametrize("exponent", [0.6, 1.0])
def test_wrong_exponent_does_no_harm(name: LawName, has_preview: bool, exponent: float) -> None:
    law = law_named(name, Plant(exponent=exponent), has_preview=has_preview)
    trial = Trial(look_ahead=8 if has_preview else 0)
    assert unstable(law, trial) == []
    assert run(law, trial).error[[45, 105, 165]] == pytest.approx(0.0, abs=0.01)


@feedback
@preview
def test_force_is_held_through_hardness_wear_and_lost_samples(
    name: LawName, has_preview: bool
) -> None:
    """Within noise between the steps; what wear adds in a revolution stays unnoticed."""
    law = law_named(name, Plant(), has_preview=has_preview)
    trial = Trial(
        harder=1.3,
        harder_from=25,
        worn=1.3,
        noise=0.03,
        lost=frozenset(range(3, 180, 7)),
        look_ahead=8 if has_preview else 0,
    )
    force = run(law, trial).force
    for quiet in (slice(40, 50), slice(85, 108), slice(150, 180)):
        assert force[quiet].mean() == pytest.approx(SET_POINT, rel=0.03)
        assert force[quiet].std() < 0.04 * SET_POINT
