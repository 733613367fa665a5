"""When data are old: after three usual intervals, and not before two seconds."""

import pytest

from service.monitor.freshness import LEARNED, ArrivalTimes, Freshness


def arrived(interval: float, *, count: int = LEARNED + 1) -> ArrivalTimes:
    arrivals = ArrivalTimes()
    for number in range(count):
        arrivals.add(number * interval)
    return arrivals


def found(
    arrivals: ArrivalTimes, now: float, *, connected: bool = True, rest: bool = False
) -> Freshness:
    return arrivals.freshness(now, is_connected=connected, is_at_rest=rest)


def test_before_the_first_observation_there_is_no_age() -> None:
    assert ArrivalTimes().age(5.0) is None
    assert found(ArrivalTimes(), 5.0) is Freshness.NONE


@pytest.mark.parametrize(("interval", "limit"), [(0.1, 2.0), (0.5, 2.0), (4.0, 12.0)])
def test_data_are_old_after_three_usual_intervals(interval: float, limit: float) -> None:
    arrivals, last = arrived(interval), LEARNED * interval
    assert arrivals.stale_after == pytest.approx(limit)
    assert found(arrivals, last + 0.99 * limit) is Freshness.FRESH
    assert found(arrivals, last + 1.01 * limit) is Freshness.STALE
    assert arrivals.age(last + 7.0) == pytest.approx(7.0)


def test_a_machine_at_rest_is_quiet_as_long_as_its_agent_answers() -> None:
    arrivals = arrived(0.1)
    assert found(arrivals, 60.0, rest=True) is Freshness.QUIET
    assert found(arrivals, 60.0, rest=True, connected=False) is Freshness.STALE


def test_a_lost_connection_makes_data_old_at_once() -> None:
    assert found(arrived(0.1), 0.6, connected=False) is Freshness.STALE


def test_an_interruption_is_no_usual_interval() -> None:
    arrivals = arrived(0.1, count=3)
    for number in range(1, 10):
        arrivals.interrupt()
        arrivals.add(100.0 * number)
    assert arrivals.stale_after == 2.0
