"""Rows of NC moves as far as the feed in force concerns them, in the order of execution."""

from collections.abc import Iterator
from dataclasses import dataclass

from stepnc_model.nc.moves import FeedMode, NcMoves


@dataclass(frozen=True, slots=True)
class FeedRow:
    """Row of the moves, as far as the feed in force concerns it."""

    block: int
    fed_by: int
    kind: int
    flags: int
    is_inverse: bool


CHUNK = 1 << 16
"""Rows that are turned into objects of Python at once."""


def feed_rows(moves: NcMoves) -> Iterator[FeedRow]:
    """Rows of the moves in the order of their execution."""
    inverse = list(FeedMode).index(FeedMode.INVERSE_TIME)
    for begin in range(0, len(moves), CHUNK):
        part = slice(begin, begin + CHUNK)
        columns = (
            moves.block[part].tolist(),
            moves.fed_by[part].tolist(),
            moves.kind[part].tolist(),
            moves.flags[part].tolist(),
            (moves.mode[part] == inverse).tolist(),
        )
        for values in zip(*columns, strict=True):
            yield FeedRow(*values)
