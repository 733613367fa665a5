"""A bucket of tokens for each client, by a clock that the test turns."""

import asyncio

import pytest

from service.errors import TooMany
from service.rest import rate
from service.rest.rate import RateLimit, SharedRateLimit
from service.storage.server_database import ServerDatabase
from tests.postgres import Server, ServerMaker, new_database, new_server, postgres_url

__all__ = ["new_database", "new_server", "postgres_url"]


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


async def taken_by(limits: list[SharedRateLimit], client: str, *, at_once: int) -> int:
    """Requests that are admitted, sent to the processes in turn, some of them at once."""
    count = 0
    for _ in range(100):
        said = await asyncio.gather(
            *(limit.take(client) for limit in limits for _ in range(at_once)),
            return_exceptions=True,
        )
        assert all(each is None or isinstance(each, TooMany) for each in said)
        count += sum(each is None for each in said)
        if None not in said:
            break
    return count


@pytest.mark.parametrize("at_once", [1, 5])
def test_processes_of_one_database_admit_a_burst_together(
    new_database: str, at_once: int
) -> None:
    # The rate is so small that nothing flows in during the test.
    limits = [SharedRateLimit(ServerDatabase(new_database), 1e-6, burst=40) for _ in range(2)]
    assert asyncio.run(taken_by(limits, "a", at_once=at_once)) == 40
    assert asyncio.run(taken_by(limits, "b", at_once=at_once)) == 40


def test_a_client_that_was_refused_asks_the_database_no_more(
    new_database: str, clock: Clock
) -> None:
    database = ServerDatabase(new_database)
    limit = SharedRateLimit(database, 0.5, burst=1, now=clock.now)
    asyncio.run(limit.take("a"))
    for _ in range(2):
        with pytest.raises(TooMany):
            asyncio.run(limit.take("a"))
    with database.writing() as connection:
        connection.execute("DELETE FROM rates")
    with pytest.raises(TooMany) as refused:
        asyncio.run(limit.take("a"))
    clock.time += refused.value.wait
    asyncio.run(limit.take("a"))


def test_without_its_database_a_process_limits_alone(
    new_server: ServerMaker, clock: Clock
) -> None:
    server: Server = new_server()
    limit = SharedRateLimit(ServerDatabase(server.url), 1.0, burst=20, now=clock.now)
    asyncio.run(limit.take("a"))
    server.stop("immediate")
    # One is left of the two that were fetched.
    assert asyncio.run(taken_by([limit], "a", at_once=1)) == 21
    server.start()
