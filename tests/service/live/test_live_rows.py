"""Rows wait until they are taken, and the lamp is lit long enough to be seen."""

from math import nan

import pytest

from controller.orders import EventKind, LoopEvent
from service.live.runner import LIT, LiveRows, Moment, known

EVENT = LoopEvent(time=1.0, kind=EventKind.ORDER, text="depth 2 -> 4 mm")


def row(time: float, *, power: float = 0.0) -> Moment:
    numbers = dict.fromkeys(Moment._fields, 0.0)
    numbers |= {"time": time, "spindle_power_true": power}
    words = {"workingstep": "", "level": "safe", "holding": "", "event": None}
    return Moment(**{**numbers, **words})  # type: ignore[arg-type]


def test_what_was_taken_does_not_come_again() -> None:
    live_rows = LiveRows(lambda: 1000.0)
    assert live_rows.last is None
    live_rows(row(0.1))
    live_rows(row(0.2))
    live_rows.note(EVENT)
    taken = live_rows.taken()
    assert [each.time for each in taken.moments] == [0.1, 0.2]
    assert taken.events == (EVENT,)
    again = live_rows.taken()
    assert (again.moments, again.events) == ((), ())
    assert live_rows.last == row(0.2)


@pytest.mark.parametrize(
    ("power", "is_overloaded"), [(1000.0, False), (1049.0, False), (1051.0, True)]
)
def test_the_noise_of_a_force_at_its_bound_lights_no_lamp(
    power: float, is_overloaded: bool
) -> None:
    live_rows = LiveRows(lambda: 1000.0)
    live_rows(row(1.0, power=power))
    assert live_rows.is_overloaded(1.0) is is_overloaded


def test_the_lamp_is_lit_for_a_while() -> None:
    live_rows = LiveRows(lambda: 1000.0)
    live_rows(row(1.0, power=2000.0))
    live_rows(row(1.1, power=900.0))
    assert live_rows.is_overloaded(1.0 + 0.9 * LIT)
    assert not live_rows.is_overloaded(1.0 + 1.1 * LIT)


def test_each_change_of_the_lamp_is_an_event() -> None:
    live_rows = LiveRows(lambda: 1000.0)
    for time, power in ((0.0, 900.0), (0.5, 2000.0), (1.0, 2000.0), (2.5, 900.0), (3.0, 900.0)):
        live_rows(row(time, power=power))
    told = [(event.time, event.kind, event.text) for event in live_rows.taken().events]
    assert told == [
        (0.5, EventKind.OVER, "power limit: the drive draws 2 kW, the motor delivers 1 kW"),
        (2.5, EventKind.SAFE, "power limit: for 1 s at most 5% above 1 kW"),
    ]


def test_a_weaker_motor_is_over_sooner() -> None:
    powers = [1000.0]
    live_rows = LiveRows(lambda: powers[0])
    live_rows(row(1.0, power=800.0))
    assert not live_rows.is_overloaded(1.0)
    powers[0] = 500.0
    live_rows(row(1.1, power=800.0))
    assert live_rows.is_overloaded(1.1)


def test_what_is_not_known_is_none() -> None:
    assert known(nan) is None
    assert known(0.0) == 0.0
