"""Rate limit of requests, with a token bucket for each client. Running state."""

import time
from collections.abc import Callable
from dataclasses import dataclass

from service.errors import TooMany

MOST_CLIENTS = 10_000
"""Largest number of clients whose buckets are kept; full buckets can be dropped."""


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
