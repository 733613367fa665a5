"""Rate limit of requests: a token bucket for each client. Running state."""

import time
from collections.abc import Callable
from dataclasses import dataclass

from service.errors import TooMany

MOST_CLIENTS = 10_000
"""whose buckets are kept; a full bucket need not be"""


@dataclass(slots=True)
class _Bucket:
    tokens: float
    at: float


class RateLimit:
    """Buckets by client, in one process.

    Parameters
    ----------
    rate : float
        Requests a second in the long run; 0: no limit.
    burst : int
        Requests at once.
    now : callable
        S.
    """

    def __init__(
        self, rate: float, *, burst: int, now: Callable[[], float] = time.monotonic
    ) -> None:
        self._rate, self._burst, self._now = rate, float(burst), now
        self._buckets: dict[str, _Bucket] = {}

    def take(self, client: str) -> None:
        """One request more.

        Raises
        ------
        TooMany
            With the time to wait.
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
        """Forget those whose buckets are full again, and if need be the oldest."""
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
