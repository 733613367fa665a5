"""Blocks of an NC program that move at a feed, and those that give cycles their feed."""

import numpy as np
from numpy.typing import NDArray

from stepnc_model.nc.moves import FeedMode, MoveFlag, MoveKind, NcMoves
from stepnc_model.nc.program import NcProgram
from stepnc_model.post.dialect import Dialect

MODES = tuple(FeedMode)
"""Feed modes by the index in :attr:`NcMoves.mode`."""

DEFINED_CYCLES = frozenset({Dialect.HEIDENHAIN, Dialect.SINUMERIK})
"""Controls whose drilling cycles have no feed in the block that executes them."""


def cycle_feed_blocks(moves: NcMoves, dialect: Dialect) -> NDArray[np.int64]:
    """Blocks that give defined cycles their feed, and nothing else.

    A definition of Heidenhain holds the feed itself; in Sinumerik the F word before the call is
    in force, which may serve other moves as well: then it is not among these blocks.
    """
    if dialect not in DEFINED_CYCLES:
        return np.zeros(0, np.int64)
    is_fed = np.isin(moves.kind, (MoveKind.LINE, MoveKind.ARC)) & (moves.fed_by >= 0)
    is_cycle = (moves.flags & int(MoveFlag.CYCLE)) != 0
    of_cycles = np.unique(moves.fed_by[is_fed & is_cycle]).astype(np.int64)
    return np.setdiff1d(of_cycles, moves.fed_by[is_fed & ~is_cycle])


class FedBlocks:
    """Rows of the blocks that move at a feed.

    Parameters
    ----------
    program : NcProgram
    blocks : (B,) array of int
        Blocks with advice, ascending.
    """

    def __init__(self, program: NcProgram, blocks: NDArray[np.int64]) -> None:
        moves = program.moves
        kinds = (MoveKind.LINE, MoveKind.ARC, MoveKind.UNKNOWN)
        fed = np.flatnonzero(np.isin(moves.kind, kinds))
        self._order = fed[np.argsort(moves.block[fed], kind="stable")]
        # As wide as what is looked up: a search would copy the array otherwise.
        self._sorted = moves.block[self._order].astype(np.int64)
        if not len(blocks):
            self._plain: frozenset[int] = frozenset()
            return
        is_plain = moves.is_advisable & (moves.mode == MODES.index(FeedMode.PER_MINUTE))
        if program.dialect in DEFINED_CYCLES:
            is_plain &= (moves.flags & int(MoveFlag.CYCLE)) == 0
        others = np.concatenate(([0], np.cumsum(~is_plain[self._order])))
        low = self._sorted.searchsorted(blocks)
        high = self._sorted.searchsorted(blocks, side="right")
        self._plain = frozenset(blocks[(high > low) & (others[high] == others[low])].tolist())

    def rows(self, block: int) -> NDArray[np.int64]:
        """Rows of a block that move at a feed."""
        low = int(self._sorted.searchsorted(block))
        high = int(self._sorted.searchsorted(block, side="right"))
        return self._order[low:high]

    def is_plain(self, block: int) -> bool:
        """True if a block with advice moves at a feed per minute, and nothing hinders it."""
        return block in self._plain
