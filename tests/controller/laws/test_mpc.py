"""Model predictive control of the cutting force."""

from dataclasses import dataclass, field, replace
from math import exp

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller.laws.horizon import EXCESS, LENGTH, MOVES
from controller.laws.law import Plant, Situation
from controller.laws.mpc import CHECKED, FALL, RISE, ModelPredictive, MpcState
from controller.signals.ports import Floats
from tests.controller.trial import DEPTHS, STRETCH, Run, Trial, run, unstable

PREVIEW = Trial(look_ahead=15)
ENTERED = 45
"""revolutions after which nothing of the entry at override 1 is left"""
CALM = Situation(force=800.0, set_point=800.0, override=1.0, actual=1.0, floor=0.1, ceiling=2.0)
LAW = ModelPredictive()


@dataclass(frozen=True, slots=True, kw_only=True)
class Watched:
    """The law, and what it was asked and answered."""

    law: ModelPredictive = field(default_factory=ModelPredictive)
    asked: list[tuple[MpcState, Situation]] = field(default_factory=list)
    answered: list[tuple[MpcState, float]] = field(default_factory=list)

    def begin(self, override: float) -> MpcState:
        return self.law.begin(override)

    def decide(self, state: MpcState, at: Situation) -> tuple[MpcState, float]:
        self.asked.append((state, at))
        self.answered.append(self.law.decide(state, at))
        return self.answered[-1]


def restless_depths(seed: int, *, longest: int) -> tuple[float, ...]:
    """Depths between 0.5 and 6 mm, each for a few revolutions."""
    chance = np.random.default_rng(seed)
    depths: list[float] = []
    while len(depths) < len(DEPTHS):
        depth = exp(chance.uniform(np.log(0.5), np.log(6.0)))
        depths += [depth] * int(chance.integers(1, longest))
    return tuple(depths[: len(DEPTHS)])


def hard_trials() -> list[Trial]:
    """Cuts that never come to rest, noisy, with and without preview."""
    return [
        Trial(
            depths=restless_depths(seed, longest=longest),
            look_ahead=ahead,
            noise=0.05,
            seed=seed,
        )
        for seed in range(3)
        for ahead in (0, 20)
        for longest in (3, 12)
    ]


# --- the program and its solution


@dataclass(frozen=True, slots=True, kw_only=True)
class Judge:
    """The same program, stated from the differences with its states and solved by Clarabel."""

    lag: float = 3.0
    axes: cp.Parameter = field(default_factory=cp.Parameter)
    command: cp.Parameter = field(default_factory=cp.Parameter)
    caps: cp.Parameter = field(default_factory=lambda: cp.Parameter(LENGTH))
    targets: cp.Parameter = field(default_factory=lambda: cp.Parameter(LENGTH))
    commands: cp.Variable = field(default_factory=lambda: cp.Variable(LENGTH))

    def program(self, floor: float, ceiling: float) -> cp.Problem:
        """To be solved again and again."""
        left = exp(-1.0 / self.lag)
        in_mean = self.lag * (1.0 - left)
        states = cp.Variable(LENGTH + 1)
        excess = cp.Variable(LENGTH, nonneg=True)
        means = in_mean * states[:-1] + (1.0 - in_mean) * self.commands
        moves = cp.diff(cp.hstack([self.command, self.commands]))
        cost = (
            cp.sum_squares(means - self.targets)
            + MOVES * cp.sum_squares(moves)
            + EXCESS * cp.sum_squares(excess)
        )
        return cp.Problem(
            cp.Minimize(cost),
            [
                states[0] == self.axes,
                states[1:] == left * states[:-1] + (1.0 - left) * self.commands,
                means - excess <= self.caps,
                self.commands >= floor,
                self.commands <= ceiling,
                moves <= RISE,
                moves >= -FALL,
            ],
        )


def caps(after: MpcState, at: Situation, *, exponent: float = 0.8) -> Floats:
    """Override at which the force of each coming revolution meets the set point."""
    assert after.log_factor is not None
    known = list(at.ahead[:LENGTH]) or [after.expected or 1.0]
    coming = np.array(known + known[-1:] * (LENGTH - len(known)))
    needed = at.set_point / (exp(after.log_factor) * coming)
    return np.clip(needed ** (1.0 / exponent), at.floor, at.ceiling)


def test_decision_is_that_of_an_independent_solver() -> None:
    watched, judge = Watched(), Judge()
    for trial in (Trial(), PREVIEW, replace(PREVIEW, noise=0.05, gain=1.4), hard_trials()[2]):
        run(watched, trial)
    program = judge.program(*Trial().band)
    left = exp(-1.0 / 3.0)
    errors = []
    for (_, at), (after, decision) in list(zip(watched.asked, watched.answered, strict=True))[
        ::6
    ]:
        assert after.is_planned
        # The end of an exponential whose mean over its last revolution is known.
        way = (at.actual - at.override) / (3.0 * (1.0 - left))
        judge.axes.value = at.override + way * left
        judge.command.value = at.override
        judge.caps.value = caps(after, at)
        judge.targets.value = np.minimum.accumulate(judge.caps.value)
        program.solve(solver=cp.CLARABEL)
        errors.append(np.log(decision / judge.commands.value[0]))
    assert len(errors) > 100
    assert np.abs(errors).max() < 1e-3


@pytest.mark.parametrize("lag", [0.5, 1.5, 3.0, 6.0, 10.0])
def test_solver_needs_few_iterations(lag: float) -> None:
    """So the time of a decision is bounded: an iteration takes about a microsecond."""
    watched = Watched(law=ModelPredictive(plant=Plant(lag=lag), iterations=150))
    for trial in [replace(each, lag=lag) for each in hard_trials()]:
        run(watched, trial)
    assert all(after.is_planned for after, _ in watched.answered)


# --- what it decides depends on state and situation only


def test_same_state_and_situation_give_the_same_decision() -> None:
    watched = Watched()
    run(watched, hard_trials()[3])
    fresh = ModelPredictive()
    wanted = watched.answered
    # Backwards, so that each call has other neighbours; and by another object.
    for law in (watched.law, fresh):
        again = [law.decide(state, at) for state, at in reversed(watched.asked)][::-1]
        assert [decision for _, decision in again] == [decision for _, decision in wanted]
        for (one, _), (other, _) in zip(again, wanted, strict=True):
            np.testing.assert_array_equal(one.plan, other.plan)
            np.testing.assert_array_equal(one.prices, other.prices)
            assert one.log_factor == other.log_factor


def test_where_the_solver_starts_changes_no_decision() -> None:
    watched = Watched()
    run(watched, PREVIEW)
    for (state, at), (_, decision) in zip(watched.asked, watched.answered, strict=True):
        cold = replace(LAW.begin(1.0), log_factor=state.log_factor, expected=state.expected)
        assert LAW.decide(cold, at)[1] == pytest.approx(decision, rel=2e-3)


def test_nothing_is_printed(capfd: pytest.CaptureFixture[str]) -> None:
    run(ModelPredictive(), Trial())
    assert capfd.readouterr() == ("", "")


# --- in the loop


@pytest.mark.parametrize("gain", [0.7, 0.85, 1.0, 1.2, 1.4])
@pytest.mark.parametrize("look_ahead", [0, 15])
def test_no_offset_whatever_the_hidden_factor(gain: float, look_ahead: int) -> None:
    steady = Trial(depths=(2.0,) * STRETCH, gain=gain, look_ahead=look_ahead)
    assert np.abs(run(LAW, steady).error[-20:]).max() < 1e-3
    harder = replace(steady, harder=1.3, harder_from=20)
    assert np.abs(run(LAW, harder).error[-15:]).max() < 1e-3


@pytest.mark.parametrize("exponent", [0.6, 0.7, 0.9, 1.0])
def test_no_offset_with_another_power_law(exponent: float) -> None:
    law = ModelPredictive(plant=Plant(exponent=exponent))
    for trial in (Trial(), PREVIEW):
        done = run(law, trial)
        for end in (ENTERED, 2 * STRETCH - 15, 3 * STRETCH):
            assert np.abs(done.error[end - 5 : end]).max() < 5e-3


@pytest.mark.parametrize("noise", [0.0, 0.03])
@pytest.mark.parametrize("look_ahead", [0, 15])
def test_stable_whatever_hidden_gain_and_lag(look_ahead: int, noise: float) -> None:
    assert unstable(LAW, Trial(look_ahead=look_ahead, noise=noise)) == []


def excess(done: Run) -> float:
    """N·s above the set point, without the entry that nobody could foresee."""
    return float(done.excess[ENTERED:].sum())


def test_preview_spares_the_doubled_force() -> None:
    blind, seeing = run(LAW, Trial()), run(LAW, PREVIEW)
    assert blind.error[STRETCH] == pytest.approx(1.0, abs=0.01)
    assert seeing.error[ENTERED:].max() < 0.01
    assert excess(seeing) < excess(blind) / 20.0
    assert seeing.actual.mean() > 0.95 * blind.actual.mean()


@pytest.mark.parametrize("lag", [1.5, 6.0])
@pytest.mark.parametrize("gain", [1.0, 1.4])
def test_preview_spares_half_even_with_another_lag(lag: float, gain: float) -> None:
    blind, seeing = (run(LAW, replace(each, gain=gain, lag=lag)) for each in (Trial(), PREVIEW))
    assert excess(seeing) < 0.5 * excess(blind)


def test_lighter_cut_is_not_answered_before_it_is_there() -> None:
    done = run(LAW, PREVIEW)
    relief = 2 * STRETCH
    np.testing.assert_allclose(done.error[relief - 15 : relief], 0.0, atol=5e-3)


def test_unknown_ahead_is_as_if_the_cut_stayed() -> None:
    state = LAW.begin(1.0)
    known = replace(CALM, force=700.0, expected=900.0)
    stays = LAW.decide(state, replace(known, ahead=(900.0,) * LENGTH))[1]
    assert LAW.decide(state, known)[1] == stays
    assert LAW.decide(state, replace(known, ahead=(0.0,) * 3))[1] == stays
    # Without the present force, what is ahead relates to nothing.
    blind = replace(known, expected=0.0)
    seen = replace(blind, ahead=(2000.0,))
    assert LAW.decide(state, seen)[1] == LAW.decide(state, blind)[1]


def test_axes_that_stand_teach_nothing() -> None:
    held = replace(CALM, force=1.0, actual=0.0)
    state, decision = LAW.decide(LAW.begin(1.0), held)
    assert state.log_factor is None
    # No cap is known but the command itself, and the axes have the way to it before them.
    assert decision == pytest.approx(1.0, abs=RISE)
    learned, _ = LAW.decide(LAW.begin(1.0), CALM)
    assert LAW.decide(learned, held)[0].log_factor == learned.log_factor


# --- when it cannot


@pytest.mark.parametrize("look_ahead", [0, 15])
def test_least_cap_is_taken_where_the_solver_does_not_finish(look_ahead: int) -> None:
    watched = Watched(law=ModelPredictive(iterations=1))
    done = run(watched, replace(PREVIEW, look_ahead=look_ahead))
    unsolved = [
        (at, after, decision)
        for (_, at), (after, decision) in zip(watched.asked, watched.answered, strict=True)
        if not after.is_planned
    ]
    assert len(unsolved) > CHECKED
    for at, after, decision in unsolved:
        wanted = min(float(caps(after, at).min()), at.override + RISE)
        assert decision == pytest.approx(wanted, rel=1e-9)
    assert np.abs(done.error[-10:]).max() < 0.01


@pytest.mark.parametrize(
    "plant", [Plant(lag=0.0), Plant(exponent=0.0), Plant(lag=float("nan"))]
)
def test_plant_without_lag_or_exponent_is_refused(plant: Plant) -> None:
    with pytest.raises(ValueError, match="above 0"):
        ModelPredictive(plant=plant)


def situations(number: st.SearchStrategy[float]) -> st.SearchStrategy[Situation]:
    """Any; floor and ceiling in their order."""
    absent = st.just(0.0) | number
    drawn = st.builds(
        Situation,
        force=number,
        set_point=number,
        override=number,
        actual=number,
        floor=number,
        ceiling=number,
        expected=absent,
        ahead=st.lists(absent, max_size=LENGTH + 5).map(tuple),
    )
    return drawn.map(
        lambda at: replace(
            at, floor=min(at.floor, at.ceiling), ceiling=max(at.floor, at.ceiling)
        )
    )


ANY = situations(st.floats(min_value=0.0, exclude_min=True, allow_infinity=False))
USUAL = situations(st.floats(0.01, 10.0))


@given(course=st.lists(ANY, min_size=1, max_size=4) | st.lists(USUAL, min_size=1, max_size=4))
def test_decision_lies_in_the_band_whatever_the_situation(course: list[Situation]) -> None:
    state = LAW.begin(course[0].override)
    for at in course:
        state, decision = LAW.decide(state, at)
        assert at.floor <= decision <= at.ceiling
        assert np.isfinite(state.plan).all()
        assert np.isfinite(state.prices).all()
