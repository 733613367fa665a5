"""Rate limit of requests, with a token bucket for each client. Running state.

Web processes that share a database on a server share the buckets as well. A process fetches
some tokens at a time, so that few requests wait for the database: all hosts together admit the
rate on average, and at once up to the burst and what each process has fetched before.
"""

import asyncio
import time
from collections.abc import Callable
from dataclasses import dataclass
from math import inf

from service.errors import TooMany, Unavailable
from service.rest.storage_queries import ASKING
from service.storage import rates
from service.storage.connection import Database

MOST_CLIENTS = 10_000
"""Largest number of clients whose buckets are kept; full buckets can be dropped."""

SHARE = 10
"""Part of the burst that a process fetches at once: one in so many."""

PATIENCE = 1.0
"""Time to wait for tokens, and to limit without them when there was no answer, in s."""

SWEEP = 60.0
"""Time between two deletions of buckets that are full again, in s."""


@dataclass(slots=True)
class _Bucket:
    tokens: float
    at: float


class RateLimit:
    """Token buckets by client, within one process.

    Parameters
    ----------
    rate : float
        Requests per second on average; 0: no limit.
    burst : int
        Requests that may be sent at once.
    now : callable
        Clock, in s.
    """

    def __init__(
        self, rate: float, *, burst: int, now: Callable[[], float] = time.monotonic
    ) -> None:
        self._rate, self._burst, self._now = rate, float(burst), now
        self._buckets: dict[str, _Bucket] = {}

    def take(self, client: str) -> None:
        """Take a token for a request of a client.

        Raises
        ------
        TooMany
            When the bucket is empty; carries the time to wait.
        """
        if not self._rate:
            return
        now = self._now()
        bucket = self._buckets.get(client)
        if bucket is None:
            self._make_room(now)
            bucket = self._buckets[client] = _Bucket(self._burst, now)
        bucket.tokens = min(self._burst, bucket.tokens + (now - bucket.at) * self._rate)
        bucket.at = now
        if bucket.tokens < 1.0:
            raise TooMany((1.0 - bucket.tokens) / self._rate)
        bucket.tokens -= 1.0

    def _make_room(self, now: float) -> None:
        """Drop clients whose buckets are full again, and if necessary the oldest ones."""
        if len(self._buckets) < MOST_CLIENTS:
            return
        refill = self._burst / self._rate
        self._buckets = {
            client: bucket
            for client, bucket in self._buckets.items()
            if now - bucket.at < refill
        }
        while len(self._buckets) >= MOST_CLIENTS:
            del self._buckets[next(iter(self._buckets))]


@dataclass(slots=True)
class _Fetched:
    tokens: int = 0
    closed_until: float = 0.0
    """Time before which the shared bucket has no token, in s."""


class SharedRateLimit:
    """Token buckets by client that all web processes of a database share.

    Parameters
    ----------
    database : Database
        Where the buckets are. While it does not answer, the process limits by itself.
    rate : float
        Requests per second on average; must be positive.
    burst : int
        Requests that may be sent at once.
    now : callable
        Clock, in s.
    """

    def __init__(
        self,
        database: Database,
        rate: float,
        *,
        burst: int,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._database, self._rate, self._burst, self._now = database, rate, burst, now
        self._alone = RateLimit(rate, burst=burst, now=now)
        self._fetched: dict[str, _Fetched] = {}
        self._swept_at = now()
        self._away_until = -inf

    async def take(self, client: str) -> None:
        """Take a token for a request of a client; see :meth:`RateLimit.take`."""
        held = self._fetched.get(client)
        if held is None:
            while len(self._fetched) >= MOST_CLIENTS:
                del self._fetched[next(iter(self._fetched))]
            held = self._fetched[client] = _Fetched()
        if not held.tokens:
            left = held.closed_until - self._now()
            if left > 0.0:
                raise TooMany(left)
            try:
                fetched = await self._soon(client)
            except (Unavailable, TimeoutError):
                self._away_until = self._now() + PATIENCE
                self._alone.take(client)
                return
            except TooMany as error:
                held.closed_until = self._now() + error.wait
                raise
            # Other requests of the client may have fetched some meanwhile.
            held.tokens += fetched
        held.tokens -= 1

    async def _soon(self, client: str) -> int:
        """Fetch at least one token; nobody waits long for a database that does not answer."""
        if self._now() < self._away_until:
            raise TimeoutError
        async with asyncio.timeout(PATIENCE):
            loop = asyncio.get_running_loop()
            return await loop.run_in_executor(ASKING, self._fetch, client)

    def _fetch(self, client: str) -> int:
        """Fetch at least one token."""
        now = self._now()
        if now - self._swept_at > SWEEP:
            self._swept_at = now
            rates.sweep(self._database, unused=self._burst / self._rate)
        most = max(self._burst // SHARE, 1)
        return rates.take(self._database, client, most=most, rate=self._rate, burst=self._burst)
