"""Transitions of the loop's state, one function of values after another."""

from collections.abc import Callable
from math import inf, nan

import numpy as np
import pytest

from controller.guard import OverrideBand, OverrideReason
from controller.laws.law import ControlLaw, Plant
from controller.monitoring.monitor import Monitor
from controller.orders import EventKind, SwitchTo
from controller.signals.preview import Preview
from controller.signals.signal import Revolution
from controller.states.loop_settings import LoopSettings
from controller.states.loop_state import (
    BELOW,
    FORGIVING,
    LEAST_WAY,
    REVOLUTIONS,
    LoopState,
    answered,
    begun,
    initial,
)
from controller.states.order_effects import obeyed
from controller.states.phase import Phase
from simulator.reading import Reading
from tests.controller.plugged import PERIOD, SET_POINT, SPINDLE_SPEED, Wishing, reading, step
from tests.controller.shown import REVOLUTION

PREVIEW = Preview(until=np.array([1.0, 100.0]), force=np.array([200.0, 800.0]))
STEPS = [step(), step(inhibition="locked", workingstep="THREAD")]


def in_cut(settings: LoopSettings | None = None, **more: object) -> LoopState:
    """In the slot, with chips."""
    settings = LoopSettings(look_ahead=0, servo_lag=0.08) if settings is None else settings
    state = begun(initial(settings, PREVIEW), reading(300.0), STEPS)
    return state._replace(has_chips=True, **more)  # type: ignore[arg-type]


def after(
    state: LoopState,
    shown: Revolution | None = REVOLUTION,
    *,
    at: Reading | None = None,
    force: float = 300.0,
    law: Callable[[Plant], ControlLaw[None]] = lambda _plant: Wishing(wish=0.9),
) -> LoopState:
    return answered(
        state,
        reading(force) if at is None else at,
        shown,
        ratio=None,
        force=force,
        law_for=law,
    )


def test_a_workingstep_begins_in_the_phase_that_it_and_the_switch_ask_for() -> None:
    state = in_cut()
    assert (state.phase, state.override) == (Phase.FOLLOWING, 1.0)
    locked = begun(state, reading(0.0, workingstep=2), STEPS)
    assert (locked.phase, locked.allowed.holding) == (
        Phase.INHIBITED,
        OverrideReason.INHIBITED,
    )
    off = obeyed(state, SwitchTo(is_on=False), plain=PREVIEW, steps=STEPS)
    assert off.phase is Phase.FOLLOWING
    assert after(off).phase is Phase.OFF
    assert begun(off, reading(0.0, workingstep=2), STEPS).phase is Phase.OFF


def test_an_overload_is_held_until_each_tooth_is_below_the_set_point() -> None:
    held = after(in_cut(), None, force=1.6 * SET_POINT)
    assert (held.phase, held.override, held.holds) == (Phase.HELD, 0.0, 1.0)
    assert held.hold is not None
    again = after(held, None, force=2.0 * SET_POINT, at=reading(0.0, override=0.5))
    assert again.hold is not None
    assert (again.hold.override, again.hold.force) == (0.5, 2.0 * SET_POINT)
    calm = after(after(again, None), None)
    assert (calm.phase, calm.hold) == (Phase.FOLLOWING, None)
    assert calm.keep.cap < 1.0
    assert calm.events[-1].kind is EventKind.RESUME


def test_a_hold_lasts_over_workingsteps_and_switches() -> None:
    held = after(in_cut(), None, force=1.6 * SET_POINT)
    off = obeyed(held, SwitchTo(is_on=False), plain=PREVIEW, steps=STEPS)
    assert begun(off, reading(0.0, workingstep=2), STEPS).phase is Phase.HELD


def test_holds_in_quick_succession_add_up_and_old_ones_are_forgotten() -> None:
    state = in_cut(holds=3.0)
    assert after(state).holds == pytest.approx(3.0 - FORGIVING)
    assert after(state._replace(holds=0.0)).holds == 0.0
    stopped = after(state, None, force=1.6 * SET_POINT)
    assert (stopped.phase, stopped.override) == (Phase.STOPPED, 0.0)
    assert [each.kind for each in stopped.events[-2:]] == [EventKind.HOLD, EventKind.STOP]
    assert after(stopped).phase is Phase.STOPPED


def test_only_an_override_that_stays_below_the_band_is_a_danger() -> None:
    # So great a force that the guard goes below the floor, and so slow that it does not hold.
    hard = REVOLUTION._replace(force=550.0, override=0.1)
    state = in_cut()
    assert after(state._replace(below=BELOW)).below == 0
    assert after(state._replace(below=BELOW - 1), hard).below == BELOW
    stopped = after(state._replace(below=BELOW), hard)
    assert stopped.is_stopped
    assert "too high even at 20 %" in stopped.events[-1].text


def waited(count: int, *, force: float) -> LoopState:
    state = in_cut(law=(Wishing(wish=1.0), None))
    for _ in range(count):
        state = after(state, None, force=force)
    return state


def test_without_samples_it_is_blind_after_the_time_allowed_and_says_so_once() -> None:
    assert waited(49, force=nan).phase is Phase.FOLLOWING
    blind = waited(51, force=nan)
    safe = OverrideBand().safe
    assert (blind.phase, blind.override, blind.law) == (Phase.BLIND, safe, None)
    events = [event.kind for event in waited(80, force=nan).events]
    assert events.count(EventKind.SILENCE) == 1
    assert begun(blind, reading(0.0), STEPS).override == safe
    assert after(blind).phase is Phase.FOLLOWING


def test_samples_that_make_no_revolution_are_waited_for_some_revolutions_more() -> None:
    most = round((0.5 + REVOLUTIONS / SPINDLE_SPEED) / PERIOD)
    assert waited(most - 1, force=1.0).phase is Phase.FOLLOWING
    assert waited(most + 1, force=1.0).phase is Phase.BLIND


def test_a_revolution_with_too_few_samples_tells_no_force() -> None:
    empty = REVOLUTION._replace(force=nan, coverage=0.2)
    assert after(in_cut(), empty).without_force == PERIOD
    assert after(in_cut(without_force=1.0)).without_force == 0.0


def test_a_slow_spindle_has_its_time_and_a_standing_one_misses_no_revolution() -> None:
    state = in_cut(without_force=1.0)
    assert state.is_blind(SPINDLE_SPEED)
    assert not state.is_blind(1.0)
    assert not state._replace(without_force=inf).is_blind(0.0)


def test_while_the_override_does_not_act_the_cut_is_left() -> None:
    rapid = after(in_cut(without_force=9.0), None, at=reading(0.0, can_override=False))
    assert (rapid.has_chips, rapid.law, rapid.without_force) == (False, None, 0.0)
    assert rapid.override == 1.0


def test_while_the_feed_is_held_only_teeth_are_looked_at() -> None:
    over = REVOLUTION._replace(force=1.3 * SET_POINT)
    assert EventKind.OVER in [event.kind for event in after(in_cut(), over).events]
    held = after(in_cut(), None, force=1.6 * SET_POINT)
    looked = after(held, over, force=1.3 * SET_POINT)
    assert EventKind.OVER not in [event.kind for event in looked.events]
    assert looked.monitor.override == over.override


def test_a_machine_that_begins_outside_of_workingsteps_is_watched_too() -> None:
    settings = LoopSettings(look_ahead=0)
    state = initial(settings, PREVIEW)._replace(expected=200.0)
    found = answered(
        state,
        reading(300.0, workingstep=0),
        REVOLUTION,
        ratio=0.1,
        force=300.0,
        law_for=lambda _plant: Wishing(wish=1.0),
    )
    assert found.phase is Phase.INHIBITED
    assert found.monitor.lives[Monitor().tool].readings == 1


class Counting:
    """Makes laws, and notes for which plants."""

    def __init__(self) -> None:
        self.plants: list[Plant] = []
        self.law = Wishing(wish=0.9)

    def __call__(self, plant: Plant) -> ControlLaw[None]:
        self.plants.append(plant)
        return self.law


def test_the_law_is_told_the_revolution_and_its_band() -> None:
    laws = Counting()
    assert after(in_cut(), law=laws).override == 0.9
    (told,) = laws.law.told
    assert (told.force, told.set_point, told.override) == (400.0, SET_POINT, 1.0)
    assert (told.actual, told.floor, told.ceiling) == (1.0, 0.2, 1.2)
    assert (told.expected, told.ahead) == (0.0, ())
    assert laws.plants == [Plant(exponent=0.8, lag=4.0)]


def test_axes_that_stand_are_told_as_slow_ones() -> None:
    laws = Counting()
    after(in_cut(), REVOLUTION._replace(override=0.0), law=laws)
    assert laws.law.told[0].actual == pytest.approx(LEAST_WAY * 0.2)


def test_what_lies_ahead_is_told_at_the_pace_of_now() -> None:
    laws = Counting()
    near = REVOLUTION._replace(progress_before=0.93, progress=0.95)
    after(in_cut(LoopSettings(look_ahead=4)), near, law=laws)
    # 20 ms a revolution: the step at 1 s lies in the third, and is seen one before.
    assert laws.law.told[0].ahead == (200.0, 800.0, 800.0, 800.0)
    assert laws.law.told[0].expected == 200.0
