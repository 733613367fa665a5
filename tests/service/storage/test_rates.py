"""Buckets that the web processes of several hosts share."""

import pytest

from service.errors import TooMany
from service.storage import rates
from service.storage.server_database import ServerDatabase


def test_a_shared_bucket_fills_by_the_clock_of_the_server(new_database: str) -> None:
    database = ServerDatabase(new_database)
    assert rates.take(database, "a", most=8, rate=1e-6, burst=8) == 8
    with pytest.raises(TooMany) as refused:
        rates.take(database, "a", most=8, rate=0.5, burst=8)
    assert refused.value.wait == pytest.approx(2.0, abs=0.5)
    with database.writing() as connection:
        connection.execute("UPDATE rates SET seen = seen - 6")
    assert rates.take(database, "a", most=8, rate=0.5, burst=8) == 3
    rates.sweep(database, unused=-1.0)
    assert rates.take(database, "a", most=8, rate=1e-6, burst=8) == 8
