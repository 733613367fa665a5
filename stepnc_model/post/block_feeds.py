"""Blocks with other feeds: one for a whole block, or one for each part of a split block.

Units mm, mm/s, mm/rev.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

from stepnc_model.errors import PostError
from stepnc_model.post.blocks import (
    Block,
    Circular,
    DrillingCycle,
    Linear,
    Rapid,
    Rate,
    Retract,
    RigidTap,
    ThreadingMove,
)
from stepnc_model.toolpath.arc import point_at
from stepnc_model.toolpath.path import Point

Numbered = tuple[int, Block]


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockPart:
    """Part of a block with a feed of its own."""

    end: float
    """End of the part over the length of the block, 0 to 1; 1 for the last part."""
    rate: float
    """Feed in the unit of the block: mm/s or mm per revolution."""
    is_per_revolution: bool = False
    """Whether the feed is per revolution."""
    reason: str = ""
    """Name of the limit that gives the feed; empty if unknown."""


class FedBlock(NamedTuple):
    """Block at its new feed; a tuple, as a long program has one for each block."""

    number: int
    """Number of the block that it comes from."""
    part: int
    """Row of the part in that block; 0 for a whole block."""
    block: Block


def with_feeds(
    blocks: Iterable[Numbered], feeds: Mapping[int, tuple[BlockPart, ...]]
) -> Iterator[FedBlock]:
    """Replace the feeds of blocks, and split those with several.

    Parameters
    ----------
    blocks : iterable of (int, Block)
        Blocks with their numbers.
    feeds : mapping
        Parts by the number of their block; a block without an entry stays as it is.

    Raises
    ------
    PostError
        When a block that is to be split has no known start.
    """
    at: Point | None = None
    for number, block in blocks:
        parts = feeds.get(number)
        if parts is None:
            yield FedBlock(number, 0, block)
        else:
            for row, part in enumerate(_parts(block, parts, at)):
                yield FedBlock(number, row, part)
        at = block.end if type(block) is Linear else _end(block, at)


def _end(block: Block, at: Point | None) -> Point | None:
    match block:
        case Linear(end=end) | Circular(end=end) | Rapid(end=end) | ThreadingMove(end=end):
            return end
        case Retract(z=z):
            return None if at is None else (at[0], at[1], z)
        case DrillingCycle(at=(x, y), retract_z=z):
            return x, y, z
        case RigidTap(start=start):
            return start
        case _:
            return at


def _parts(block: Block, parts: tuple[BlockPart, ...], at: Point | None) -> Iterator[Block]:
    if isinstance(block, DrillingCycle):
        yield _cycle(block, parts[0].rate)
        return
    if not isinstance(block, (Linear, Circular)):
        yield block
        return
    if len(parts) == 1:
        # Made anew: copies by ``replace`` take several times as long, once in each block.
        rate = Rate(value=parts[0].rate, mode=block.rate.mode)
        yield (
            Linear(end=block.end, rate=rate)
            if isinstance(block, Linear)
            else replace(block, rate=rate)
        )
        return
    if at is None:
        raise PostError(f"a block cannot be split: its start is unknown ({block})")
    begin = 0.0
    for part in parts:
        end = block.end if part is parts[-1] else point_at(at, block, part.end)
        rate = replace(block.rate, value=part.rate)
        if isinstance(block, Circular):
            arc = replace(block.arc, turn=block.arc.turn * (part.end - begin))
            yield replace(block, end=end, arc=arc, rate=rate)
        else:
            yield Linear(end=end, rate=rate)
        begin = part.end


def _cycle(cycle: DrillingCycle, value: float) -> DrillingCycle:
    """Drilling cycle at another feed, with its expansion."""

    def at_rate(block: Block) -> Block:
        if isinstance(block, (Linear, Circular)):
            return replace(block, rate=replace(block.rate, value=value))
        return block

    rate = replace(cycle.rate, value=value)
    return replace(cycle, rate=rate, expansion=tuple(map(at_rate, cycle.expansion)))
