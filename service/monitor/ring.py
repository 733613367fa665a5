"""Recent rows of a monitored machine, in bounded memory."""

from collections.abc import Sequence

import numpy as np

from simulator.motion.segments import Floats

MOST_ROWS = 36_000
"""Rows that are kept: an hour at 10 rows per second, 4 MB."""


class RowRing:
    """Latest rows, ascending in time, which is the first column. Running state.

    Parameters
    ----------
    width : int
        Number of columns.
    most : int
        Number of rows that are kept.
    """

    def __init__(self, width: int, *, most: int = MOST_ROWS) -> None:
        # Twice the room, so that the kept rows are always in one piece.
        self._values = np.empty((2 * most, width))
        self._most, self._begin, self._end = most, 0, 0
        self.count = 0
        """Number of rows since the beginning, also of those that are no longer kept."""

    def __len__(self) -> int:
        return self._end - self._begin

    @property
    def last_time(self) -> float | None:
        """Time of the latest row, in s; None if there is none."""
        return float(self._values[self._end - 1, 0]) if len(self) else None

    def add(self, row: Sequence[float]) -> None:
        """Add a row; it replaces the latest one if it has the same time."""
        if len(self) and self._values[self._end - 1, 0] == row[0]:
            self._values[self._end - 1] = row
            return
        if self._end == len(self._values):
            kept = self._most - 1
            self._values[:kept] = self._values[self._end - kept :]
            self._begin, self._end = 0, kept
        self._values[self._end] = row
        self._end += 1
        self.count += 1
        self._begin = max(self._begin, self._end - self._most)

    def clear(self) -> None:
        """Forget all rows."""
        self._begin = self._end = 0

    def rows(self, since: int = 0) -> Floats:
        """Return a copy of the kept rows after the first ``since`` ones, (N, C)."""
        fresh = min(max(self.count - since, 0), len(self))
        return self._values[self._end - fresh : self._end].copy()
