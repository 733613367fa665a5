from dataclasses import replace
from math import inf, log
from re import fullmatch

import numpy as np
import pytest

from controller.guard import WorkingstepBounds
from controller.monitoring.monitor import CALM, LASTS, PAUSE, REACH, Monitor
from controller.orders import EventKind, LoopEvent
from controller.signals.preview import Expected
from controller.signals.signal import Revolution
from simulator.physics.tooth_means import Arcs
from tests.controller.shown import REVOLUTION

KEEP = WorkingstepBounds(set_point=400.0, breakage=2000.0, floor=0.2, ceiling=1.2, exponent=0.8)
PERIOD = REVOLUTION.period
LAND_SHARE = 1.85


class Watching:
    """A monitor that is shown one revolution after another."""

    def __init__(self, keep: WorkingstepBounds = KEEP) -> None:
        self.monitor = Monitor().begun("mill")
        self.events: list[LoopEvent] = []
        self.keep = keep
        self._time = 0.0

    def show(self, force: float, *, ratio: float | None = None, **more: float) -> None:
        self._time += PERIOD
        shown: Revolution = REVOLUTION._replace(
            time=self._time,
            force=force,
            tooth_means=np.full(4, force),
            **more,  # type: ignore[arg-type]
        )
        self.look(self.monitor.seen(shown, self.keep, ratio=ratio, land_share=LAND_SHARE))

    def look(self, monitor: Monitor) -> None:
        self.monitor = monitor
        self.events += monitor.events

    def is_over(self) -> bool:
        return self.monitor.over.is_lasting

    @property
    def kinds(self) -> list[EventKind]:
        return [event.kind for event in self.events]


def test_a_quiet_cut_tells_nothing() -> None:
    watching = Watching()
    for _ in range(100):
        watching.show(390.0, ratio=0.0)
    assert watching.events == []


def test_what_is_worse_is_told_at_once_and_what_is_better_when_it_has_lasted() -> None:
    watching = Watching()
    for force in (300.0, 490.0, 300.0):
        watching.show(force)
    assert watching.kinds == [EventKind.OVER]
    for _ in range(round(CALM / PERIOD) + 1):
        watching.show(300.0)
    assert watching.kinds == [EventKind.OVER, EventKind.SAFE]


def test_a_force_that_flickers_about_a_threshold_is_told_once() -> None:
    watching = Watching()
    for _ in range(1500):
        watching.show(485.0)
        watching.show(475.0)
    assert watching.kinds == [EventKind.OVER]


def test_a_set_point_out_of_reach_is_told_once_in_a_workingstep() -> None:
    watching = Watching()
    for _ in range(3 * REACH):
        watching.show(450.0, override=0.2)
    assert watching.kinds == [EventKind.UNREACHABLE]
    assert "450 N at an override of 20 %" in watching.events[0].text
    watching.monitor = watching.monitor.begun("mill")
    for _ in range(REACH):
        watching.show(450.0, override=0.2)
    assert watching.kinds == [EventKind.UNREACHABLE] * 2


@pytest.mark.parametrize(("force", "override"), [(450.0, 0.3), (410.0, 0.2)])
def test_above_the_floor_or_at_the_set_point_it_is_within_reach(
    force: float, override: float
) -> None:
    watching = Watching()
    for _ in range(3 * REACH):
        watching.show(force, override=override)
    assert watching.events == []


def test_a_force_that_stays_a_little_above_its_set_point_is_told_with_its_time() -> None:
    """A twelfth above is no warning by itself."""
    watching = Watching()
    for _ in range(round(LASTS / PERIOD) + 1):
        watching.show(436.0)
    assert watching.kinds == [EventKind.OVER]
    words = (
        r"force 1\.09 times the set point of 400 N for 3(\.\d+)? s: 436 N, limit 1\.05 times"
    )
    assert fullmatch(words, watching.events[0].text)
    assert watching.is_over()
    for _ in range(20):
        watching.show(396.0)
    assert not watching.is_over()
    for _ in range(round(CALM / PERIOD) + 1):
        watching.show(396.0)
    assert watching.kinds == [EventKind.OVER, EventKind.SAFE]


def test_entries_and_steps_are_not_over_for_long() -> None:
    watching = Watching()
    for _ in range(20):
        for force in [436.0] * 50 + [390.0] * 50:
            watching.show(force)
    assert watching.events == []


def test_where_nothing_bounds_the_force_no_level_is_told() -> None:
    watching = Watching(replace(KEEP, set_point=inf))
    for force in (300.0, 1e6, 300.0):
        watching.show(force)
    assert watching.events == []


def test_a_jump_in_hardness_is_told_from_wear() -> None:
    worn = Watching()
    for wear in np.linspace(0.0, 0.1, 3000):
        worn.show(390.0, ratio=log(1.0 + LAND_SHARE * wear))
    assert worn.events == []
    assert worn.monitor.lives["mill"].flank_wear == pytest.approx(0.1, abs=0.01)
    harder = Watching()
    for ratio in [0.0] * 200 + [log(1.3)] * 50:
        harder.show(390.0, ratio=ratio)
    assert harder.kinds == [EventKind.HARDNESS]
    assert "+30 %" in harder.events[0].text
    assert "harder" in harder.events[0].text


def test_softer_work_is_told_as_such() -> None:
    softer = Watching()
    for ratio in [0.0] * 200 + [log(0.7)] * 50:
        softer.show(390.0, ratio=ratio)
    assert "softer" in softer.events[0].text


def test_changes_one_after_another_are_not_all_told() -> None:
    watching = Watching()
    for turn in range(3000):
        watching.show(390.0, ratio=0.4 if turn % 200 < 100 else 0.0)
    assert 1 <= len(watching.events) <= 3000 * PERIOD / PAUSE + 1


def test_a_worn_out_tool_is_told_once_in_its_life() -> None:
    watching = Watching()
    for wear in np.linspace(0.0, 0.33, 6000):
        watching.show(390.0, ratio=log(1.0 + LAND_SHARE * wear))
    watching.monitor = watching.monitor.begun("drill")
    watching.monitor = watching.monitor.begun("mill")
    for flicker in range(400):
        wear = 0.33 if flicker % 2 else 0.25
        watching.show(390.0, ratio=log(1.0 + LAND_SHARE * wear))
    assert watching.kinds.count(EventKind.WEAR) == 1
    assert "tool 'mill'" in watching.events[-1].text


THIN = Expected(
    force=np.full(4, 400.0),
    change=np.zeros(4),
    arcs=Arcs(entry_angle=np.full(4, 2.5), exit_angle=np.full(4, 3.0), lag=np.zeros(4)),
)
"""each tooth alone in its period"""


def turned(watching: Watching, *means: float, time: float = 1.0) -> None:
    """One revolution more of teeth that take so much."""
    taken = np.array(means)
    shown = REVOLUTION._replace(time=time, force=float(taken.mean()), tooth_means=taken)
    watching.look(watching.monitor.seen(shown, KEEP, ratio=None, expected=THIN))


def test_a_broken_tooth_is_told_once_with_its_number_and_its_force() -> None:
    watching = Watching()
    for _ in range(5):
        turned(watching, 400.0, 400.0, 400.0, 400.0)
    for turn in range(10):
        turned(watching, 400.0, 0.0, 700.0, 400.0, time=2.0 + turn)
    assert watching.kinds == [EventKind.BREAKAGE]
    assert watching.events[0].text == (
        "tooth 2 of 4 takes no chip: 0.00 of the mean force in the period of tooth 2, "
        "1.00 with intact teeth"
    )
    assert watching.monitor.breakage.is_broken


def test_the_way_out_of_a_cut_and_the_way_in_are_no_broken_tooth() -> None:
    """In both, the same tooth may be in the air: neither confirms the other."""
    watching = Watching()
    for _ in range(5):
        for _ in range(30):
            turned(watching, 400.0, 400.0, 400.0, 400.0)
        for _ in range(2):
            turned(watching, 400.0, 0.0, 400.0, 400.0)
            watching.monitor = watching.monitor.out_of_cut()
    assert watching.events == []


@pytest.mark.parametrize(
    ("force", "words"),
    [
        (
            380.0,
            "force 1.27 times the mean of the last 40 revolutions: 380 N, limit 1.11 times",
        ),
        (492.0, "force 1.23 times the set point of 400 N: 492 N, limit 1.2 times"),
    ],
)
def test_a_warning_says_which_rule_tripped_and_with_what_numbers(
    force: float, words: str
) -> None:
    watching = Watching()
    for _ in range(40):
        watching.show(300.0)
    watching.show(force)
    assert [event.text for event in watching.events] == [words]


def test_each_tool_has_its_own_life() -> None:
    watching = Watching()
    for _ in range(60):
        watching.show(390.0, ratio=0.2)
    watching.monitor = watching.monitor.begun("drill")
    assert watching.monitor.lives["drill"].readings == 0
    assert watching.monitor.lives["mill"].readings == 60
