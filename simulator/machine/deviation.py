"""Random deviation of the power that motors draw, one factor for each movement.

A movement is the motion of one NC block; where a block has several motions, as a drilling cycle
with its rapids and feeds, each change between rapid and feed begins another movement. All
powers of axes and spindle during a movement, [1]_ §3.3, are multiplied by the same uniform
random factor; base load and coolant do not depend on the movement and stay exact, and so do
forces and the power at the edge. While the axes stand still there is no movement.

The factor of a movement depends only on the seed and on the number of the movement in the run,
so that it is the same at any sampling rate.

References
----------
.. [1] D. Lechevalier et al., "Simulating a virtual machining model in an agent-based model for
   advanced analytics", 2018, §3.3, §4.1 and §4.2: ±10 % in feed, ±5 % in traverse.
"""

from dataclasses import dataclass

import numpy as np

from simulator.machine.disturbance import uniform
from simulator.motion.segments import Bools, Floats, Ints, Segments
from simulator.spec import PowerDeviation


@dataclass(frozen=True, slots=True, kw_only=True)
class SeededDeviation:
    """Power deviation of one run, with its random seed.

    Raises
    ------
    ValueError
        If the seed is negative.
    """

    deviation: PowerDeviation
    seed: int = 0

    def __post_init__(self) -> None:
        if self.seed < 0:
            raise ValueError(f"seed {self.seed} must be at least 0")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GivenDeviation:
    """Power deviation of one run whose factors were drawn before."""

    factors: Floats
    """Factor on the motor powers of each movement of the run, in order, (M,)."""


def movement_of(segments: Segments) -> Ints:
    """Number of the movement to which each segment belongs, (N,), from 0 in steps of 1."""
    is_new = (np.diff(segments.block) != 0) | np.diff(segments.is_rapid)
    return np.concatenate(([0], np.cumsum(is_new))).astype(np.int64)


def movement_kinds(segments: Segments) -> Bools:
    """True if each movement of a stretch is a rapid, (M,)."""
    _, begins = np.unique(movement_of(segments), return_index=True)
    return segments.is_rapid[begins]


def movement_factors(
    deviation: SeededDeviation | GivenDeviation, is_rapid: Bools, *, first: int
) -> Floats:
    """Factors on the motor powers of consecutive movements.

    Parameters
    ----------
    deviation : SeededDeviation or GivenDeviation
    is_rapid : (M,) array of bool
        Whether each movement is a rapid.
    first : int
        Number of the first of these movements in the run, counted from 0.

    Returns
    -------
    (M,) array
        Within 1 ± the half-width of its kind.
    """
    if isinstance(deviation, GivenDeviation):
        return deviation.factors[first : first + len(is_rapid)]
    words = np.random.SeedSequence([deviation.seed, *b"power of movements"])
    key = np.asarray(words.generate_state(2, np.uint64), dtype=np.uint64)
    drawn = uniform(key, first, len(is_rapid))
    width = np.where(is_rapid, deviation.deviation.traverse, deviation.deviation.feed)
    factors: Floats = 1.0 + width * (2.0 * drawn - 1.0)
    return factors
