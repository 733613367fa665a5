"""A bucket of tokens for each client, by a clock that the test turns."""

import pytest

from service.errors import TooMany
from service.rest import rate
from service.rest.rate import RateLimit


class Clock:
    time = 0.0

    def now(self) -> float:
        return self.time


@pytest.fixture
def clock() -> Clock:
    return Clock()


def taken(limit: RateLimit, client: str) -> int:
    count = 0
    while count < 10_000:
        try:
            limit.take(client)
        except TooMany:
            return count
        count += 1
    return count


def test_a_burst_is_taken_and_then_the_rate(clock: Clock) -> None:
    limit = RateLimit(2.0, burst=5, now=clock.now)
    assert taken(limit, "a") == 5
    clock.time = 1.0
    assert taken(limit, "a") == 2
    clock.time = 100.0
    assert taken(limit, "a") == 5


def test_the_wait_that_is_told_is_long_enough(clock: Clock) -> None:
    limit = RateLimit(0.5, burst=1, now=clock.now)
    limit.take("a")
    with pytest.raises(TooMany) as refused:
        limit.take("a")
    assert refused.value.wait == pytest.approx(2.0)
    clock.time += refused.value.wait + 1e-9
    limit.take("a")


def test_clients_have_buckets_of_their_own(clock: Clock) -> None:
    limit = RateLimit(1.0, burst=3, now=clock.now)
    assert (taken(limit, "a"), taken(limit, "b")) == (3, 3)


def test_without_a_rate_all_are_taken() -> None:
    assert taken(RateLimit(0.0, burst=1), "a") == 10_000


def test_many_clients_take_no_more_room(clock: Clock, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rate, "MOST_CLIENTS", 50)
    limit = RateLimit(1.0, burst=3, now=clock.now)
    for number in range(500):
        limit.take(f"client {number}")
        assert len(limit._buckets) <= 50
    clock.time = 10.0
    limit.take("one more")
    assert len(limit._buckets) == 1
