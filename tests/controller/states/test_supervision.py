"""What the loop can no longer do is told, and told again when it can."""

import numpy as np
import pytest

from controller.orders import EventKind
from controller.signals.preview import Preview
from controller.states.loop_settings import LoopSettings
from controller.states.loop_state import LoopState, initial
from controller.states.phase import Phase
from controller.states.supervision import resolved, supervised
from tests.controller.plugged import reading
from tests.controller.shown import REVOLUTION

PREVIEW = Preview(until=np.array([1e6]), force=np.array([400.0]))
STATE = initial(LoopSettings(), PREVIEW)


def told(state: LoopState) -> list[EventKind]:
    return [event.kind for event in state.events]


def test_an_override_without_effect_is_told_once_and_its_return_too() -> None:
    state = STATE
    for _ in range(30):
        state = supervised(state, reading(100.0, period=0.05, override=0.5))
    assert told(state) == [EventKind.ASTRAY]
    assert "100 % commanded, 50 % run" in state.events[0].text
    state = supervised(state, reading(100.0, override=1.0))
    assert told(state) == [EventKind.ASTRAY, EventKind.FOLLOWED]


@pytest.mark.parametrize("phase", [Phase.OFF, Phase.INHIBITED])
def test_what_is_not_commanded_need_not_be_followed(phase: Phase) -> None:
    state = STATE._replace(phase=phase)
    for _ in range(30):
        state = supervised(state, reading(100.0, period=0.05, override=0.5))
    assert state.events == ()


def test_readings_that_show_no_teeth_are_told_with_their_period() -> None:
    averaged = REVOLUTION._replace(by_teeth=False)
    long = reading(100.0, period=0.012, spindle_speed=40.0, teeth=4)
    state = resolved(resolved(STATE, long, averaged), long, averaged)
    assert told(state) == [EventKind.AVERAGED]
    assert "readings of 12 ms where a tooth takes 6.25 ms" in state.events[0].text
    state = resolved(state, long, REVOLUTION)
    assert told(state) == [EventKind.AVERAGED] * 2
    assert "broken teeth are looked for" in state.events[-1].text
