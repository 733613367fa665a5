"""The plant on which control laws are tried: log-linear, with a lagging feed drive.

3000 rpm, force ``F = K·g(t)·u^0.8`` with u the override that the axes run, first-order lag of
three revolutions, force measured as its mean over one revolution, and a law that answers once a
revolution. Depth of cut 2 → 4 → 1 mm, 60 revolutions each, entered from air at override 1.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import exp
from typing import TypeVar

import numpy as np

from controller.laws.law import ControlLaw, Situation
from controller.signals.ports import Floats

S = TypeVar("S")

REVOLUTION = 0.02
"""s, at 3000 rpm"""
SUBSTEPS = 10
"""of a revolution"""
EXPONENT = 0.8
STRETCH = 60
"""revolutions at each depth"""
DEPTHS = (2.0,) * STRETCH + (4.0,) * STRETCH + (1.0,) * STRETCH
"""mm in each revolution"""
PER_DEPTH = 500.0
"""N per mm of depth at override 1"""
SET_POINT = 800.0
"""N: override 1 at depth 2 gives a quarter too much"""
BAND = (0.1, 2.0)
SETTLED = 0.05
"""of the set point"""
CALM = 10
"""revolutions within, after which the force has settled"""
ENTERED = STRETCH // 2
"""revolution from which the entry is over; the slow-down before the step is not yet due"""
TAIL = 30
"""last revolutions, in which a stable law is at rest"""
RESTLESS = 0.05
"""standard deviation of ln F"""
GAINS = (0.5, 0.75, 1.0, 1.5, 2.0)
LAGS = (1.5, 3.0, 6.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """What is cut and with what; the law knows none of it but what a situation tells."""

    depths: Sequence[float] = DEPTHS
    """mm in each revolution, as they are"""
    announced: Sequence[float] = ()
    """mm in each revolution, as the program has them; empty: as they are"""
    look_ahead: int = 0
    """revolutions of the program that the law sees; 0: nothing is known, nor expected"""
    gain: float = 1.0
    """K, the hidden factor on the force"""
    harder: float = 1.0
    """further factor from the revolution ``harder_from`` on"""
    harder_from: int = 0
    worn: float = 1.0
    """further factor at the end, reached in a straight line"""
    lag: float = 3.0
    """of the feed drive, revolutions"""
    noise: float = 0.0
    """of a measured force, relative standard deviation"""
    seed: int = 1
    lost: frozenset[int] = frozenset()
    """revolutions after which there is no reading and the law is not called"""
    band: tuple[float, float] = BAND
    start: float = 1.0
    """override in the air before"""
    set_point: float = SET_POINT

    @property
    def expected(self) -> Floats:
        """N that is expected at override 1, in each revolution."""
        return PER_DEPTH * np.asarray(self.announced or self.depths)

    def aheads(self) -> list[tuple[float, ...]]:
        """What is expected after each revolution, the greatest of three neighbours each."""
        expected = self.expected.tolist()
        guarded = [max(expected[max(at - 1, 0) : at + 2]) for at in range(len(expected))]
        return [
            tuple(guarded[at + 1 : at + 1 + self.look_ahead]) for at in range(len(expected))
        ]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Run:
    """What came of a trial, (N,) each: one entry a revolution."""

    trial: Trial
    force: Floats
    """N, true mean"""
    excess: Floats
    """N·s above the set point"""
    command: Floats
    """override that was commanded for the revolution"""
    actual: Floats
    """override that the axes ran, mean"""
    situations: tuple[Situation, ...]
    """that the law was asked about"""

    @property
    def error(self) -> Floats:
        """Force over set point, less one."""
        return np.asarray(self.force / self.trial.set_point - 1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Score:
    """How well a law did, in the terms of the literature."""

    peak: float
    """force over set point less one, greatest at the step 2 → 4"""
    settling: tuple[int, ...]
    """revolutions from each change of depth until the force is within 5 % for ten"""
    rms: float
    """of force over set point less one"""
    excess: float
    """N·s above the set point, entry apart"""
    mean_override: float


def run(law: ControlLaw[S], trial: Trial) -> Run:
    """The law in the loop with the plant."""
    count = len(trial.depths)
    noise = np.random.default_rng(trial.seed).normal(0.0, trial.noise, count)
    wear = np.linspace(1.0, trial.worn, count)
    expected, aheads = trial.expected.tolist(), trial.aheads()
    decay = exp(-1.0 / (SUBSTEPS * trial.lag)) ** np.arange(1, SUBSTEPS + 1)
    state, command, axis = law.begin(trial.start), trial.start, trial.start
    rows: list[tuple[float, float, float, float]] = []
    situations: list[Situation] = []
    for revolution, depth in enumerate(trial.depths):
        factor = trial.gain * wear[revolution] * PER_DEPTH * depth
        factor *= trial.harder if revolution >= trial.harder_from else 1.0
        axes = command + (axis - command) * decay
        forces = factor * axes**EXPONENT
        axis, mean = float(axes[-1]), float(forces.mean())
        over = np.maximum(forces - trial.set_point, 0.0).mean() * REVOLUTION
        rows.append((mean, float(over), command, float(axes.mean())))
        if revolution in trial.lost:
            continue
        situation = Situation(
            force=mean * max(0.05, 1.0 + float(noise[revolution])),
            set_point=trial.set_point,
            override=command,
            actual=float(axes.mean()),
            floor=trial.band[0],
            ceiling=trial.band[1],
            expected=expected[revolution] if trial.look_ahead else 0.0,
            ahead=aheads[revolution],
        )
        situations.append(situation)
        state, command = law.decide(state, situation)
    force, excess, commands, actual = np.array(rows).T
    return Run(
        trial=trial,
        force=force,
        excess=excess,
        command=commands,
        actual=actual,
        situations=tuple(situations),
    )


def score(done: Run) -> Score:
    """The figures of a run."""
    depths = done.trial.depths
    changes = [0, *(at for at in range(1, len(depths)) if depths[at] != depths[at - 1])]
    ends = [*changes[1:], len(depths)]
    error = done.error
    up = slice(STRETCH, 2 * STRETCH)
    return Score(
        peak=float(error[up].max()),
        settling=tuple(_settling(error[at:end]) for at, end in zip(changes, ends, strict=True)),
        rms=float(np.sqrt((error**2).mean())),
        excess=float(done.excess[ENTERED:].sum()),
        mean_override=float(done.actual.mean()),
    )


def _settling(error: Floats) -> int:
    """Revolutions until the error stays small; all if it never does."""
    within = np.abs(error) <= SETTLED
    calm = [row for row in range(len(error)) if within[row : row + CALM].all()]
    return calm[0] if calm else len(error)


def is_restless(done: Run) -> bool:
    """Whether the last revolutions still swing, or the override goes from end to end."""
    tail = done.command[-TAIL:]
    floor, ceiling = done.trial.band
    at_both = bool((tail <= floor).any() and (tail >= ceiling).any())
    return at_both or float(np.log(done.force[-TAIL:]).std()) > RESTLESS


def variants(trial: Trial) -> list[Trial]:
    """The trial with fifteen pairs of hidden gain and lag."""
    return [replace(trial, gain=gain, lag=lag) for gain, lag in product(GAINS, LAGS)]


def unstable(law: ControlLaw[S], trial: Trial) -> list[Trial]:
    """Those of the fifteen variants that never come to rest."""
    return [each for each in variants(trial) if is_restless(run(law, each))]
