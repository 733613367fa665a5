"""What the laws do in the whole loop: noise, tooth periods, signal processing and guard.

Everything is seeded. Forces are those of the machine's truth, not of its dynamometer.
"""

from dataclasses import replace
from functools import lru_cache
from itertools import product

import numpy as np
import pytest

from controller.laws.choice import LawName
from controller.orders import Criterion
from controller.signals.preview import LOOK_AHEAD
from simulator.plant.hidden_behaviour import HiddenTruth
from tests.closed_loop.trials import (
    GAINS,
    GUARDED,
    HARD,
    HARDER,
    KNOWN,
    LAGS,
    LAWS,
    LOST,
    REVOLUTION,
    SET_POINT,
    SOFT,
    UNKNOWN,
    WORN,
    Run,
    Score,
    Trial,
    is_restless,
    run,
    score,
    settled,
    unstable,
)

law = pytest.mark.parametrize("name", LAWS)
preview = pytest.mark.parametrize("look_ahead", [0, LOOK_AHEAD], ids=["alone", "preview"])


@lru_cache(maxsize=64)
def scored(name: LawName, trial: Trial) -> Score:
    return score(run(name, trial))


def overloaded(done: Run) -> int:
    """Revolutions above 1.5 times the set point."""
    return int((done.force.mean(axis=1) > 1.5 * SET_POINT).sum())


@law
def test_no_law_that_only_feeds_back_avoids_the_double_force(name: LawName) -> None:
    """Force is in proportion to depth; a law that decides soon after the step meets less."""
    assert 0.74 < scored(name, KNOWN).peak < 1.05


@law
@pytest.mark.parametrize("trial", [KNOWN, SOFT, HARD], ids=["known", "softer", "harder"])
def test_preview_takes_most_of_the_excess(name: LawName, trial: Trial) -> None:
    """At least half was asked for. What is left is noise around the set point."""
    without = scored(name, trial)
    ahead = scored(name, replace(trial, look_ahead=LOOK_AHEAD))
    assert ahead.excess < without.excess / 4.0
    assert ahead.peak < 0.1
    assert ahead.feed > 0.85 * without.feed


@law
def test_no_variant_of_the_machine_makes_it_unstable(name: LawName) -> None:
    assert unstable(name, KNOWN) == []


@law
@pytest.mark.parametrize("gain", [min(GAINS), max(GAINS)])
@pytest.mark.parametrize("lag", [min(LAGS), max(LAGS)])
def test_preview_stays_stable_in_the_corners(name: LawName, gain: float, lag: float) -> None:
    """All fifteen are tried by the benchmark."""
    hidden = HiddenTruth(force_factor=gain, servo_lag=lag * REVOLUTION)
    assert not is_restless(run(name, replace(KNOWN, look_ahead=LOOK_AHEAD, hidden=hidden)))


def test_restless_is_what_swings_or_goes_from_end_to_end() -> None:
    """The yardstick itself."""
    done = run(LawName.LOG_PI, KNOWN)
    turn = (-1.0) ** np.arange(len(done.command))
    ends = np.where(turn > 0.0, KNOWN.band.floor, KNOWN.band.ceiling)
    assert not is_restless(done)
    assert is_restless(replace(done, force=done.force * (1.0 + 0.1 * turn[:, None])))
    assert is_restless(replace(done, command=ends))


@law
@preview
@pytest.mark.parametrize("trial", [HARDER, WORN], ids=["harder", "worn"])
def test_force_settles_at_its_set_point(name: LawName, look_ahead: int, trial: Trial) -> None:
    """Within 2 %, noise and wear included, where 5 % were asked for."""
    off = settled(run(name, replace(trial, look_ahead=look_ahead)))
    assert off == pytest.approx([0.0] * len(trial.depths), abs=0.02)


@law
@preview
def test_lost_samples_and_silence_are_survived(name: LawName, look_ahead: int) -> None:
    """A fifth of the samples of a cut that is interrupted: means of a revolution err by 6 %."""
    done = run(name, replace(LOST, look_ahead=look_ahead))
    assert not done.is_stopped
    assert settled(done) == pytest.approx([0.0] * 3, abs=0.06)


@law
@preview
def test_quality_never_raises_the_feed(name: LawName, look_ahead: int) -> None:
    """The soft work at depth 1 would bear more than the ceiling of twice the feed."""
    trial = replace(SOFT, look_ahead=look_ahead)
    done = run(name, replace(trial, criterion=Criterion.QC))
    assert done.command.max() <= 1.0
    assert done.actual.max() <= 1.0 + 1e-9
    assert scored(name, trial).feed > 1.1


@law
@preview
def test_guard_ends_an_overload_that_nobody_announced(name: LawName, look_ahead: int) -> None:
    """The depth doubles unknown to the program: the feed is held once, and goes on."""
    done = run(name, replace(UNKNOWN, look_ahead=look_ahead, band=GUARDED))
    assert overloaded(done) <= 3
    assert done.holds >= 1
    assert not done.is_stopped
    bare = scored(name, replace(UNKNOWN, look_ahead=look_ahead))
    assert score(done).excess < 0.9 * bare.excess


def test_without_a_law_the_force_is_what_the_program_makes_it() -> None:
    """2000 N at depth 4 where 800 N are allowed, for 19 revolutions at the programmed feed."""
    done = run(LawName.NONE, KNOWN)
    assert score(done).peak == pytest.approx(1.5, rel=0.01)
    assert overloaded(done) == pytest.approx(19, abs=1)


def test_eight_revolutions_of_look_ahead_see_enough() -> None:
    """Whatever the hidden factor and lag, four more only cost feed."""
    feeds = {}
    for look_ahead in (8, 12):
        scores = [
            scored(LawName.LOG_PI, replace(KNOWN, look_ahead=look_ahead, hidden=hidden))
            for hidden in (
                HiddenTruth(force_factor=factor, servo_lag=lag * REVOLUTION)
                for factor, lag in product((0.7, 1.4), (1.5, 6.0))
            )
        ]
        assert max(each.peak for each in scores) < 0.03
        feeds[look_ahead] = float(np.mean([each.feed for each in scores]))
    assert feeds[8] > 1.01 * feeds[12]


def test_four_teeth_tell_the_same() -> None:
    trial = replace(KNOWN, look_ahead=LOOK_AHEAD)
    two, four = (scored(LawName.LOG_PI, replace(trial, teeth=teeth)) for teeth in (2, 4))
    assert four.peak == pytest.approx(two.peak, abs=0.02)
    assert four.feed == pytest.approx(two.feed, rel=0.02)
