"""Random numbers of a shop: one stream for each machine and purpose.

A stream is seeded by the seed of the run, the replication, and a hash of the names of its owner
and its purpose. So a machine that is added or moved changes no number of another, and a seed
gives the same run everywhere: the hash is BLAKE2, not Python's own, which changes from process
to process.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from hashlib import blake2b
from itertools import chain, repeat

import numpy as np

from extras.factory.model.distribution import Distribution, DistributionKind, Floats

BLOCK = 256
"""Numbers drawn at a time."""


class Blocks:
    """Numbers that come in blocks and are taken in other quantities. Running state.

    Parameters
    ----------
    source : iterator of (..., N) arrays
        Blocks, without end.
    """

    def __init__(self, source: Iterator[Floats]) -> None:
        self._source = source
        self._block, self._size, self._at = np.empty(0), 0, 0

    def take(self, count: int) -> Floats:
        """Next numbers, (..., count)."""
        begin, end = self._at, self._at + count
        while end > self._size:
            block = next(self._source)
            if begin < self._size:
                block = np.concatenate((self._block[..., begin:], block), axis=-1)
            self._block, self._size = block, block.shape[-1]
            begin, end = 0, count
        self._at = end
        return self._block[..., begin:end]


@dataclass(frozen=True, slots=True, kw_only=True)
class Streams:
    """Source of random streams of one run."""

    seed: int
    replication: int = 0

    def generator(self, owner: str, purpose: str) -> np.random.Generator:
        """Generator of an owner for a purpose."""
        digest = blake2b(f"{owner}\0{purpose}".encode(), digest_size=16).digest()
        words = np.frombuffer(digest, dtype="<u4").tolist()
        key = (self.replication, *words)
        return np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=key))

    def numbers(self, distribution: Distribution, owner: str, purpose: str) -> Iterator[float]:
        """Numbers of a distribution, one after another without end."""
        if distribution.kind is DistributionKind.CONSTANT:
            return repeat(distribution.mean)
        blocks = self.blocks(distribution, owner, purpose)
        return chain.from_iterable(block.tolist() for block in blocks)

    def blocks(self, distribution: Distribution, owner: str, purpose: str) -> Iterator[Floats]:
        """Numbers of a distribution in blocks, without end."""
        if distribution.kind is DistributionKind.CONSTANT:
            return repeat(np.full(BLOCK, distribution.mean))
        generator = self.generator(owner, purpose)
        return (distribution.draw(generator, BLOCK) for _ in repeat(None))
