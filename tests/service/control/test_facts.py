"""What table, page and JSON have in common adds up, and says why in words."""

from collections.abc import Callable
from dataclasses import replace
from math import exp

import pytest

from controller.orders import EventKind, LoopEvent
from controller.record import RunRecord
from service.control.facts import (
    ControlRow,
    disturbed,
    disturbed_words,
    event_counts,
    exceeded,
    law_words,
    mode_words,
    rows,
    saved,
    whole,
)
from service.control.holding import TOP
from service.control.run import ControlRun, control
from tests.asking import AskedControl

Controlled = Callable[..., AskedControl]


def row(**changed: object) -> ControlRow:
    """A minute of cutting."""
    record = RunRecord(
        workingstep=1, time=80.0, cutting_time=60.0, revolutions=3000, set_point=500.0
    )
    for name, value in changed.items():
        setattr(record, name, value)
    return ControlRow(id="A", begin=0.0, planned=90.0, record=record, shares=((TOP, 0.997),))


def test_workingsteps_add_up(control_run: ControlRun) -> None:
    found, total = rows(control_run), whole(control_run)
    assert sum(each.planned for each in found) == pytest.approx(control_run.progress)
    for name in ("time", "cutting_time", "impulse", "excess", "over_time"):
        parts = [getattr(each.record, name) for each in found]
        assert sum(parts) == pytest.approx(getattr(total.record, name))
    assert total.record.peak == max(each.record.peak for each in found)
    assert total.factor is None


def test_the_factor_is_that_of_the_logarithms(control_run: ControlRun) -> None:
    found = rows(control_run)[-1]
    assert found.factor is not None
    assert found.factor[0] == pytest.approx(exp(found.record.ratio.log_mean))
    assert found.bound


@pytest.mark.parametrize(("over", "has_stayed"), [(0.0, False), (5.9, False), (6.1, True)])
def test_a_tenth_of_the_cut_above_the_set_point_is_too_much(
    over: float, has_stayed: bool
) -> None:
    assert row(over_time=over).has_stayed_over is has_stayed


def test_reasons_are_words() -> None:
    one = row(overrides=72.0)
    assert one.why == f"override 120 %, limited by {TOP}"
    some = replace(one, shares=((TOP, 0.9), ("roughness", 0.097), ("rate limit", 0.003)))
    assert some.why == (
        f"override 120 %, limited by {TOP} 90 %, roughness 10 %, rate limit < 1 % of the cut"
    )
    assert replace(one, shares=()).why == "no chips: nothing to control"
    thread = replace(one, inhibition="the feed is bound to the pitch of the thread")
    assert thread.why == "feed not controlled: the feed is bound to the pitch of the thread"


def test_nothing_is_exceeded_in_a_good_run(control_run: ControlRun) -> None:
    assert exceeded(control_run, rows(control_run)) == ()


def test_a_stop_is_told_with_its_reason(control_run: ControlRun) -> None:
    stop = LoopEvent(time=7.5, kind=EventKind.STOP, text="a tooth is broken")
    stopped = replace(control_run, events=(*control_run.events, stop), is_stopped=True)
    assert exceeded(stopped, ()) == ("stopped at 7.50 s: a tooth is broken",)
    assert event_counts(stopped).endswith("1 stop") or "1 stop," in event_counts(stopped)


def test_a_force_that_stays_above_is_told(control_run: ControlRun) -> None:
    (text,) = exceeded(control_run, [row(over_time=30.0)])
    assert text == "A: 30 s of 60 s with chips above 1.05 times the set point of 500 N"


def test_a_disturbance_that_never_came_is_told(control_run: ControlRun) -> None:
    assert disturbed(control_run) == (
        ("hardness:+40%@7.5s", True), ("kc:1.1", True), ("mode:QC@900s", False),
    )  # fmt: skip
    assert disturbed_words(control_run).endswith("mode:QC@900s (the run ended before)")
    assert disturbed_words(replace(control_run, disturbances=())) == "nothing"


def test_law_and_mode_are_told_as_they_were(
    control_run: ControlRun, controlled: Controlled
) -> None:
    assert (law_words(control_run), mode_words(control_run)) == ("log-pi", "TC")
    run = control(*controlled(has_preview=True, look_ahead=7, disturbances=("mode:QC@0s",)))
    assert law_words(run) == "log-pi with preview of 7 revolutions"
    assert mode_words(run) == "QC at the end"


def test_time_is_won_or_lost(control_run: ControlRun) -> None:
    assert (
        saved(replace(control_run, time=8.0, progress=10.0))
        == "2.0 s shorter than 10.0 s (20.0%)"
    )
    assert (
        saved(replace(control_run, time=11.0, progress=10.0))
        == "1.0 s longer than 10.0 s (10.0%)"
    )
    assert saved(replace(control_run, time=0.0, progress=0.0)) == "nothing was run"
