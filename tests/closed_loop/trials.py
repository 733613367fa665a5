"""Trials of the whole loop on the virtual machine, judged by what the machine really did.

The plant of the laws' own trial (:mod:`tests.controller.trial`) with everything that lies
between a law and a machine: tooth periods, a noisy and drifting dynamometer, the loop with its
signal processing and guard. 3000 rpm, feed drives with a lag of three revolutions, force in
proportion to ``feed^0.8`` and to the depth. Depths stay for 60 revolutions each at the feed
that holds the set point. Units mm, s, N.
"""

from dataclasses import dataclass, field, replace
from itertools import pairwise, product
from typing import Any, Protocol

import numpy as np

from controller.guard import OverrideBand
from controller.laws.choice import LawName, law_named
from controller.laws.law import ControlLaw, Plant, Situation
from controller.loop import Loop
from controller.orders import Criterion, EventKind
from controller.reference import Reference
from controller.signals.ports import Override, Sensor
from controller.signals.preview import Preview
from controller.signals.source import Dynamometer
from controller.states.loop_settings import LoopSettings, LoopStep
from simulator.motion.segments import Floats
from simulator.plant.controlled_machine import ControlledMachine, Instrumentation
from simulator.plant.course import NominalCourse
from simulator.plant.dynamometer import DYNAMOMETER
from simulator.plant.hidden_behaviour import HiddenChange, HiddenQuantity, HiddenTruth
from tests.simulator.plant.courses import EXPONENT, LAND_SHARE, SPEED, TEETH, course

LAWS = tuple(name for name in LawName if name is not LawName.NONE)

REVOLUTION = 1.0 / SPEED
PLANT = Plant(exponent=EXPONENT, lag=3.0)
"""what laws are tuned for: the lag of the settings at this speed"""
STRETCH = 60
"""revolutions at each depth while the force is at its set point"""
PER_DEPTH = 500.0
"""N per mm of depth at override 1"""
SET_POINT = 800.0
"""N: override 1 at depth 2 gives a quarter too much"""
CELL = 0.01
"""s of the program in a cell of the course"""
AIR = 51
"""cells before the entry; odd, so that it falls into the middle of a revolution"""
ENTRY = AIR * CELL

LOOSE = OverrideBand(floor=0.1, ceiling=2.0, rise=100.0, overload_ratio=100.0)
"""the guard stands aside: what is seen is the law"""
GUARDED = OverrideBand(floor=0.1, ceiling=2.0)

SETTLED = 0.05
"""of the set point; noise moves the true force by less than a tenth of that"""
CALM = 10
"""revolutions within, after which the force has settled"""
ENTERED = STRETCH // 2
"""revolution of the cut from which the entry is over"""
QUIET = (0.45, 0.65)
"""share of a stretch in which the force should be at rest: preview has not begun to slow down
before the next one"""
TAIL = 30
"""last revolutions, in which a stable loop is at rest"""
RESTLESS = 0.05
"""standard deviation of ln F"""
GAINS = (0.5, 0.75, 1.0, 1.5, 2.0)
LAGS = (1.5, 3.0, 6.0)
"""revolutions"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """What is cut, with what, and how the loop is set."""

    depths: tuple[float, ...] = (2.0, 4.0, 1.0)
    """mm, as the program has them"""
    lengths: tuple[float, ...] = ()
    """mm of depth by which the length of each is reckoned; empty: ``depths``"""
    hidden: HiddenTruth = field(default_factory=HiddenTruth)
    bench: Instrumentation = field(default_factory=lambda: Instrumentation(seed=1))
    look_ahead: int = 0
    """revolutions; 0: the law is told nothing"""
    band: OverrideBand = LOOSE
    criterion: Criterion = Criterion.TC
    teeth: int = TEETH


def _override(depth: float) -> float:
    """Override that holds the set point at a depth."""
    return float((SET_POINT / (PER_DEPTH * depth)) ** (1.0 / EXPONENT))


def _changes(what: HiddenQuantity, *values: float) -> tuple[HiddenChange, ...]:
    """One change after each stretch."""
    times = (ENTRY + STRETCH * REVOLUTION * (row + 1) for row in range(len(values)))
    return tuple(
        HiddenChange(time=time, what=what, value=value)
        for time, value in zip(times, values, strict=True)
    )


def _silence(revolution: int) -> HiddenTruth:
    """A sensor that is silent for 0.3 s from a revolution of the cut on."""
    time = ENTRY + revolution * REVOLUTION
    return HiddenTruth(
        changes=(HiddenChange(time=time, what=HiddenQuantity.SILENCE, value=0.3),)
    )


WEAR = 0.3 * SET_POINT / (LAND_SHARE * PER_DEPTH * 4.0)
"""mm of flank wear that adds 30 % of the set point where the cut is deepest"""

LOSSY = Instrumentation(dynamometer=replace(DYNAMOMETER, missing=0.2), seed=1)

KNOWN = Trial()
UNKNOWN = Trial(
    depths=(2.0, 2.0, 2.0),
    lengths=(2.0, 4.0, 1.0),
    hidden=HiddenTruth(changes=_changes(HiddenQuantity.DEPTH, 2.0, 0.5)),
)
HARDER = Trial(
    depths=(2.0, 2.0), hidden=HiddenTruth(changes=_changes(HiddenQuantity.HARDNESS, 1.3))
)
WORN = Trial(hidden=HiddenTruth(wear_rate=WEAR / (3 * STRETCH * REVOLUTION)))
LOST = Trial(bench=LOSSY, hidden=_silence(STRETCH // 6))
BLIND = Trial(bench=LOSSY, hidden=_silence(STRETCH - 5))
SOFT = Trial(hidden=HiddenTruth(force_factor=0.7))
HARD = Trial(hidden=HiddenTruth(force_factor=1.4))

TRIALS: dict[str, Trial] = {
    "(a) depth 2 → 4 → 1 mm, known to the program": KNOWN,
    "(b) the same depths, unknown to the program": UNKNOWN,
    "(c) hardness +30 %": HARDER,
    "(d) wear, at 4 mm +30 % of the set point, over the run of (a)": WORN,
    "(e) (a) with 20 % of samples lost, 0.3 s of silence in a steady cut": LOST,
    "(e') the same, the silence while the depth doubles": BLIND,
    "(f) (a) with a hidden factor 0.7 on the force": SOFT,
    "(f') (a) with a hidden factor 1.4 on the force": HARD,
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Run:
    """What the machine really did, M revolutions with chips."""

    trial: Trial
    force: Floats
    """(M, z) N, true mean of each tooth period"""
    load: Floats
    """(M,) N that the program and its hidden steps make at override 1, wear apart"""
    actual: Floats
    """(M,) override that the axes ran"""
    command: Floats
    """(M,) override that was commanded for the next revolution"""
    measured: Floats
    """(M,) N, mean of each revolution as the loop had it; NaN: not told"""
    holds: int
    """of the feed, after an overload"""
    is_stopped: bool
    situations: tuple[Situation, ...]
    """that the law was asked about"""

    @property
    def error(self) -> Floats:
        """(M,) mean force of a revolution over the set point, less one."""
        return np.asarray(self.force.mean(axis=1) / SET_POINT - 1.0)

    @property
    def stretches(self) -> list[slice]:
        """Revolutions between steps of the load."""
        steps = 1 + np.flatnonzero(np.diff(self.load))
        edges = [0, *steps.tolist(), len(self.load)]
        return [slice(begin, end) for begin, end in pairwise(edges)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Score:
    """How well the loop did."""

    peak: float
    """mean force of a revolution from any tooth on over the set point less one, greatest, entry
    apart: where in a revolution the law happens to decide makes no difference"""
    excess: float
    """N·s above the set point, entry apart"""
    feed: float
    """mean override with chips"""
    settling: tuple[int, ...]
    """revolutions from each step of the load until the force is within 5 % for ten"""
    rms: float
    """of force over set point less one"""


class _Listening:
    """A law, and what it was asked. Running state."""

    def __init__(self, law: ControlLaw[Any], situations: list[Situation]) -> None:
        self._law, self._situations = law, situations

    def begin(self, override: float) -> Any:
        return self._law.begin(override)

    def decide(self, state: Any, at: Situation) -> tuple[Any, float]:
        self._situations.append(at)
        return self._law.decide(state, at)


class Plugged(Sensor, Override, Protocol):
    """A machine: both sockets of the loop."""


def planned(trial: Trial) -> NominalCourse:
    """What the program of a trial does."""
    cells = [
        round(STRETCH * REVOLUTION * _override(each) / CELL)
        for each in trial.lengths or trial.depths
    ]
    force = np.repeat(PER_DEPTH * np.array((0.0, *trial.depths)), [AIR, *cells])
    made = course(force, cell=CELL)
    return replace(made, teeth=np.full(len(made), trial.teeth))


def machine(trial: Trial) -> ControlledMachine:
    """The machine of a trial."""
    return ControlledMachine(planned(trial), trial.hidden, trial.bench)


def law_of(name: LawName, trial: Trial) -> ControlLaw[Any]:
    """A law, tuned for what the loop takes the machine for."""
    return law_named(name, PLANT, has_preview=trial.look_ahead > 0)


def loop(on: Plugged, law: ControlLaw[Any], trial: Trial) -> Loop:
    """The loop of a trial."""
    program = planned(trial)
    step = LoopStep(reference=Reference(workingstep="trial"), exponent=EXPONENT)
    return Loop(
        on,
        on,
        source=Dynamometer(10.0),
        law=lambda _plant: law,
        steps=[step],
        preview=Preview(
            until=program.until,
            force=program.force,
            land_force=program.land_force,
            arcs=program.arcs,
        ),
        settings=LoopSettings(
            set_point=SET_POINT,
            band=trial.band,
            look_ahead=trial.look_ahead,
            criterion=trial.criterion,
        ),
    )


def run(name: LawName, trial: Trial) -> Run:
    """The loop with a law on the machine of a trial."""
    on, asked = machine(trial), list[Situation]()
    looped = loop(on, _Listening(law_of(name, trial), asked), trial)
    rows: list[tuple[float, ...]] = []
    holds = 0
    while not looped.state.is_stopped and (cycle := looped.cycle()) is not None:
        load = float(on.course.force[on.truth.cell])
        load *= on.factors[HiddenQuantity.DEPTH] * on.factors[HiddenQuantity.HARDNESS]
        measured = np.nan if cycle.revolution is None else cycle.revolution.force
        overrides = cycle.reading.override, cycle.allowed.override
        rows.append((on.truth.force, load, *overrides, measured))
        holds += sum(event.kind is EventKind.HOLD for event in cycle.events)
    whole = len(rows) // trial.teeth * trial.teeth
    grid = np.array(rows[:whole]).reshape(-1, trial.teeth, 5)
    grid = grid[grid[:, -1, 1] > 0.0]
    return Run(
        trial=trial,
        force=grid[:, :, 0],
        load=grid[:, -1, 1],
        actual=grid[:, :, 2].mean(axis=1),
        command=grid[:, -1, 3],
        measured=grid[:, -1, 4],
        holds=holds,
        is_stopped=looped.state.is_stopped,
        situations=tuple(asked),
    )


def score(done: Run) -> Score:
    """The figures of a run."""
    error, teeth = done.error, done.trial.teeth
    over = np.maximum(done.force[ENTERED:] - SET_POINT, 0.0)
    anywhere = np.convolve(done.force[ENTERED:].ravel(), np.full(teeth, 1.0 / teeth), "valid")
    return Score(
        peak=float(anywhere.max()) / SET_POINT - 1.0,
        excess=float(over.mean(axis=1).sum()) * REVOLUTION,
        feed=float(done.actual.mean()),
        settling=tuple(_settling(error[each]) for each in done.stretches),
        rms=float(np.sqrt((error**2).mean())),
    )


def settled(done: Run) -> list[float]:
    """Mean force over set point, less one, in the quiet part of each stretch."""
    return [float(done.error[each].mean()) for each in quiet(done)]


def quiet(done: Run) -> list[slice]:
    """Revolutions of each stretch in which the force should be at rest."""
    return [
        slice(*(each.start + int(share * (each.stop - each.start)) for share in QUIET))
        for each in done.stretches
    ]


def is_restless(done: Run) -> bool:
    """Whether the last revolutions still swing, or the override goes from end to end."""
    tail, band = done.command[-TAIL:], done.trial.band
    at_both = bool((tail <= band.floor).any() and (tail >= band.ceiling).any())
    swing = float(np.log(done.force[-TAIL:].mean(axis=1)).std())
    return done.is_stopped or at_both or swing > RESTLESS


def variants(trial: Trial) -> list[Trial]:
    """The trial with fifteen pairs of hidden gain and lag."""
    return [
        replace(
            trial,
            hidden=replace(trial.hidden, force_factor=gain, servo_lag=lag * REVOLUTION),
        )
        for gain, lag in product(GAINS, LAGS)
    ]


def unstable(name: LawName, trial: Trial) -> list[Trial]:
    """Those of the fifteen variants that never come to rest."""
    return [each for each in variants(trial) if is_restless(run(name, each))]


def _settling(error: Floats) -> int:
    """Revolutions until the error stays small; all if it never does."""
    within = np.abs(error) <= SETTLED
    calm = [row for row in range(len(error)) if within[row : row + CALM].all()]
    return calm[0] if calm else len(error)
