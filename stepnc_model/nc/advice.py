"""Advice on the feeds of NC code, block by block, and what became of it."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from math import isfinite

from stepnc_model.nc.written_lines import WrittenLines


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockAdvice:
    """Feeds along the move of one block."""

    block: int
    """Index of the block in the file."""
    ends: tuple[float, ...]
    """End of each piece as a fraction of the move, rising; the last is 1."""
    feeds: tuple[float, ...]
    """Feed of each piece, mm/s."""
    reason: str = ""
    """Reason for a comment, such as the limit that is active."""
    note: str = ""
    """Comment that is written where the block changes."""

    def __post_init__(self) -> None:
        if len(self.ends) != len(self.feeds) or not self.ends or self.ends[-1] != 1.0:
            raise ValueError(
                f"block {self.block}: {len(self.ends)} ends and {len(self.feeds)} feeds, "
                "the last end must be 1"
            )
        before = 0.0
        for end, feed in zip(self.ends, self.feeds, strict=True):
            if not before < end <= 1.0:
                raise ValueError(f"block {self.block}: end {end:g} must rise within (0, 1]")
            if not (isfinite(feed) and feed > 0.0):
                raise ValueError(f"block {self.block}: feed {feed:g} mm/s must be positive")
            before = end


@dataclass(frozen=True, slots=True, kw_only=True)
class UnchangedBlock:
    """Block whose advice was not followed, or only in one piece."""

    block: int
    line: int
    reason: str
    is_unsplit: bool = False
    """Whether the block got its least feed in one piece."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RewrittenCode:
    """Rewritten NC program."""

    data: bytes
    changed: int
    """Number of blocks whose feed was changed."""
    added: int
    """Number of blocks that were added by splitting."""
    restored: int
    """Number of blocks that got the programmed feed back."""
    unchanged: tuple[UnchangedBlock, ...]
    lines: WrittenLines = field(default_factory=WrittenLines)
    """Lines of the program that the rewritten lines come from."""


def least_of(advice: Iterable[BlockAdvice]) -> dict[int, BlockAdvice]:
    """Join several pieces of advice on one block to the least feed at every place."""
    joined: dict[int, BlockAdvice] = {}
    for each in advice:
        other = joined.get(each.block)
        joined[each.block] = each if other is None else _least(other, each)
    return joined


def _least(one: BlockAdvice, other: BlockAdvice) -> BlockAdvice:
    ends = sorted({*one.ends, *other.ends})
    feeds = [min(_at(one, end), _at(other, end)) for end in ends]
    return BlockAdvice(
        block=one.block,
        ends=tuple(ends),
        feeds=tuple(feeds),
        reason=one.reason or other.reason,
        note=one.note or other.note,
    )


def _at(advice: BlockAdvice, end: float) -> float:
    """Feed of the piece that ends at a fraction or contains it."""
    pairs = zip(advice.ends, advice.feeds, strict=True)
    return next(feed for at, feed in pairs if end <= at)
