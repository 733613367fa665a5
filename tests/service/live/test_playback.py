"""Wall time for a run, by a clock that the test turns."""

from math import inf, nan
from threading import TIMEOUT_MAX

import pytest

from service.live.playback import LEAST, MOST, PlaybackClock
from service.simulation.run_collector import MOST_SECONDS
from tests.every_case import every_case


class Clock:
    """Turned by those who wait."""

    def __init__(self) -> None:
        self.time = 100.0
        self.waits: list[float] = []

    def now(self) -> float:
        return self.time

    def wait(self, seconds: float) -> None:
        self.waits.append(seconds)
        self.time += seconds


@pytest.mark.parametrize("factor", [0.5, 1.0, 10.0])
def test_the_machines_time_passes_by_the_factor(factor: float) -> None:
    clock = Clock()
    pace = PlaybackClock(factor, now=clock.now, wait=clock.wait)
    for machine_time in (1.0, 2.0, 5.0):
        pace.wait_for(machine_time)
        assert clock.time - 100.0 == pytest.approx(machine_time / factor)
    assert pace.factor == factor


def test_who_is_late_does_not_wait_and_catches_up() -> None:
    clock = Clock()
    pace = PlaybackClock(1.0, now=clock.now, wait=clock.wait)
    clock.time += 3.0
    pace.wait_for(2.0)
    assert clock.waits == []
    pace.wait_for(4.0)
    assert clock.waits == pytest.approx([1.0])


def test_the_longest_run_at_the_least_pace_is_within_what_a_clock_can_wait() -> None:
    clock = Clock()
    PlaybackClock(LEAST, now=clock.now, wait=clock.wait).wait_for(MOST_SECONDS)
    assert clock.waits == [pytest.approx(MOST_SECONDS / LEAST)]
    assert clock.waits[0] < TIMEOUT_MAX


def test_nobody_waits_without_a_pace() -> None:
    clock = Clock()
    PlaybackClock(0.0, now=clock.now, wait=clock.wait).wait_for(1e9)
    assert clock.waits == []


@every_case("factor", [-1.0, 1e-300, 0.0099, MOST + 1.0, inf, nan])
def test_a_pace_beyond_its_bounds_is_refused(factor: float) -> None:
    with pytest.raises(ValueError, match=r"it must be 0\.01 to 1000, or 0"):
        PlaybackClock(factor)
