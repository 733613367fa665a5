"""Time of a program: its blocks under a control, with the pauses that the control makes.

A control model plans every block; to that come a pause at the end of each block, in which the
control looks whether the axes stand, and one wait where the spindle starts. Both are fitted
to measured times, in seconds, by least squares. Units mm, s.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import nnls
from scipy.stats import t as student

from simulator.errors import CalibrationError
from simulator.motion.segments import Floats, Kinematics, Motion, Segments

CONFIDENCE = 0.95
FEWEST_RUNS = 3
FINE = 400
"""points between which the time in a block is interpolated"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pauses:
    """Pauses that a control adds to the motion, each with half of its 95 % interval."""

    per_block: float
    """s"""
    per_block_half: float
    at_start: float
    """s, while the spindle starts"""
    at_start_half: float


NO_PAUSES = Pauses(per_block=0.0, per_block_half=0.0, at_start=0.0, at_start_half=0.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class ProgramRun:
    """A program by time.

    Times count from the start; while the control pauses the axes stand at the end of a block.
    """

    segments: Segments
    """N lines and arcs, each a block"""
    motion: Motion
    """of all of them"""
    pauses: Pauses
    start_block: int
    """number of blocks before the spindle starts"""

    @cached_property
    def _begins(self) -> Floats:
        """(N,) s, start of each block."""
        blocks = np.arange(len(self.segments))
        moved = np.concatenate([[0.0], self.motion.ends[:-1]])
        waited = np.where(blocks >= self.start_block, self.pauses.at_start, 0.0)
        begins: Floats = moved + waited + self.pauses.per_block * blocks
        return begins

    @cached_property
    def _spans(self) -> Floats:
        """(N,) s, motion of each block."""
        return np.diff(np.concatenate([[0.0], self.motion.ends]))

    @property
    def spindle_start(self) -> float:
        """Time at which the spindle starts, s."""
        return float(self._begins[self.start_block]) - self.pauses.at_start

    @property
    def duration(self) -> float:
        """Of the whole program, s."""
        return float(self._begins[-1] + self._spans[-1]) + self.pauses.per_block

    def blocks_before(self, station: float) -> int:
        """Number of blocks that end at a station in mm or before it."""
        return int(np.searchsorted(np.cumsum(self.segments.length), station, side="right"))

    def at(self, times: Floats) -> Kinematics:
        """State of the axes at (M,) times in s."""
        block = np.clip(np.searchsorted(self._begins, times, side="right") - 1, 0, None)
        since = np.clip(times - self._begins[block], 0.0, self._spans[block])
        return self.motion.at((self.motion.ends - self._spans)[block] + since)

    def time_at(self, station: float) -> float:
        """Time at which a station in mm is reached, s; the whole duration beyond the end."""
        ends = np.cumsum(self.segments.length)
        block = int(np.searchsorted(ends, station))
        if block >= len(ends):
            return self.duration
        times = self._begins[block] + np.linspace(0.0, self._spans[block], FINE)
        along = station - (ends - self.segments.length)[block]
        stations = self.at(times[:-1]).station
        return float(np.interp(along, np.append(stations, self.segments.length[block]), times))


@dataclass(frozen=True, slots=True, kw_only=True)
class ObservedTime:
    """Observed time of a run."""

    seconds: float
    """measured"""
    motion: float
    """s, of the motion alone, to where the run ended"""
    blocks: int
    """that it finished"""


def fitted_pauses(observed: Sequence[ObservedTime]) -> Pauses:
    """Pauses that explain the time which the motion alone does not take.

    Raises
    ------
    CalibrationError
        Fewer than three runs, or all of them with the same number of blocks.
    """
    blocks = np.array([float(run.blocks) for run in observed])
    if len(observed) < FEWEST_RUNS or np.ptp(blocks) == 0.0:
        raise CalibrationError(
            f"{len(observed)} runs over {blocks.min():g} to {blocks.max():g} blocks: pauses per"
            f" block and at the start need at least {FEWEST_RUNS} runs of different lengths"
        )
    missing = np.array([run.seconds - run.motion for run in observed])
    table = np.stack([blocks, np.ones(len(observed))], axis=1)
    values, left = nnls(table, missing)
    freedom = len(observed) - 2
    spread = left**2 / freedom * np.linalg.inv(table.T @ table)
    half = float(student.ppf(0.5 + 0.5 * CONFIDENCE, freedom)) * np.sqrt(np.diag(spread))
    return Pauses(
        per_block=float(values[0]),
        per_block_half=float(half[0]),
        at_start=float(values[1]),
        at_start_half=float(half[1]),
    )
