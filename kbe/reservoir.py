"""Reservoir sampling: a bounded random sample of a stream of any length.

Each value is equally likely to be kept. The sample is exact while the stream is no longer than
the reservoir. Its choice is drawn from a seed, so the same stream gives the same sample.

References
----------
.. [1] J. S. Vitter, "Random sampling with a reservoir", ACM Trans. Math. Software 11 (1985),
   37-57, algorithm R.
.. [2] R. J. Hyndman, Y. Fan, "Sample quantiles in statistical packages", The American
   Statistician 50 (1996), 361-365: definition 7.
"""

from random import Random

CAPACITY = 1000
"""Size of the sample; the 95th percentile is then known to ±1.4 percentage points."""
SEED = 14649


class Reservoir:
    """Random sample of a stream of values (mutable state)."""

    def __init__(self, capacity: int = CAPACITY, *, seed: int = SEED) -> None:
        self._capacity = capacity
        self._random = Random(seed)
        self._kept: list[float] = []
        self._count = 0

    def add(self, value: float) -> None:
        """Add one value of the stream, [1]_."""
        self._count += 1
        if len(self._kept) < self._capacity:
            self._kept.append(value)
            return
        place = self._random.randrange(self._count)
        if place < self._capacity:
            self._kept[place] = value

    def quantile(self, share: float) -> float | None:
        """Value below which a share of the stream lies, [2]_; None without values."""
        if not self._kept:
            return None
        ranked = sorted(self._kept)
        place = share * (len(ranked) - 1)
        low = min(int(place), len(ranked) - 2) if len(ranked) > 1 else 0
        high = min(low + 1, len(ranked) - 1)
        return ranked[low] + (place - low) * (ranked[high] - ranked[low])
