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

from simulator.factory.distribution import Distribution, DistributionKind

BLOCK = 64
"""Numbers drawn at a time."""


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
        generator = self.generator(owner, purpose)
        blocks = (distribution.draw(generator, BLOCK).tolist() for _ in repeat(None))
        return chain.from_iterable(blocks)
