"""A loop on a virtual machine whose truth stays known, and laws that mean it harm."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from math import inf
from typing import Any

import numpy as np

from controller.cycle import LoopCycle
from controller.laws.law import ControlLaw, Plant, Situation
from controller.laws.log_pi import LogPI
from controller.loop import Loop
from controller.orders import EventKind, LoopEvent
from controller.reference import ForceBound, Reference
from controller.signals.ports import Floats, Reading
from controller.signals.preview import Preview
from controller.signals.source import Dynamometer, Source
from controller.states.loop_settings import LoopSettings, LoopStep
from optimiser.solver.problem import LimitName
from simulator.plant.controlled_machine import ControlledMachine, Instrumentation
from simulator.plant.course import NominalCourse
from simulator.plant.dynamometer import DYNAMOMETER, POWER_METER, Acquisition, Instrument
from simulator.plant.hidden_behaviour import HiddenTruth
from tests.simulator.plant.courses import EXPONENT

SET_POINT = 400.0
"""N"""

BREAKAGE = 1200.0
"""N"""


def reference(
    *,
    set_point: float = SET_POINT,
    breakage: float = BREAKAGE,
    floor: float = 0.0,
    ceiling: float = inf,
    inhibition: str = "",
) -> Reference:
    """A workingstep with one bound on the force."""
    bound = ForceBound(name=LimitName.TOOL_DEFLECTION, words="deflection", force=set_point)
    return Reference(
        workingstep="SLOT",
        bounds=(bound,),
        breakage=breakage,
        floor=floor,
        ceiling=ceiling,
        inhibition=inhibition,
    )


def step(of: Reference) -> LoopStep:
    """The slot of :mod:`tests.simulator.plant.courses`."""
    return LoopStep(reference=of, exponent=EXPONENT, tool="mill", diameter=10.0)


class Watched:
    """A dynamometer that errs, on a machine with a perfect one. Running state."""

    def __init__(self, machine: ControlledMachine, by: Instrument, *, seed: int) -> None:
        self.truth: list[float] = []
        """N, mean of each tooth period so far"""
        self._machine = machine
        self._instrument = Acquisition(by, np.random.default_rng(seed))

    def read(self) -> Reading | None:
        """See :class:`controller.signals.ports.Sensor`."""
        reading = self._machine.read()
        if reading is None:
            return None
        force = reading.force
        is_lost = bool(np.isnan(force).any())
        # While the machine's own sensor is silent, the mean of all teeth is what is known.
        self.truth.append(self._machine.truth.force if is_lost else float(force.mean()))
        return reading._replace(force=self._shown(reading, is_lost=is_lost))

    def _shown(self, reading: Reading, *, is_lost: bool) -> Floats:
        interval = reading.period / len(reading.force)
        return self._instrument.shown(
            np.nan_to_num(reading.force), time=reading.time, interval=interval, is_lost=is_lost
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Hostile:
    """A law that wants what it was told to want, whatever the force, over and over."""

    wishes: tuple[float, ...]

    def begin(self, _override: float) -> int:
        """See :class:`controller.laws.law.ControlLaw`."""
        return 0

    def decide(self, state: int, _at: Situation) -> tuple[int, float]:
        """See :class:`controller.laws.law.ControlLaw`."""
        return state + 1, self.wishes[state % len(self.wishes)]


@dataclass(kw_only=True)
class Rig:
    """A loop and what it ran. Running state."""

    machine: ControlledMachine
    sensor: Watched
    loop: Loop
    cycles: list[LoopCycle] = field(default_factory=list)

    @property
    def events(self) -> list[LoopEvent]:
        """All that were told."""
        return [event for cycle in self.cycles for event in cycle.events]

    def told(self, kind: EventKind) -> list[LoopEvent]:
        """Those of a kind."""
        return [event for event in self.events if event.kind is kind]

    def run(self, until: float = inf, *, most: int = 100_000) -> "Rig":
        """To a time or so many cycles, or to the end of the program or its stop."""
        while self.machine.time < until and not self.loop.state.is_stopped:
            if len(self.cycles) >= most:
                break
            cycle = self.loop.cycle()
            if cycle is None:
                break
            self.cycles.append(cycle)
        return self

    def between(self, begin: float, end: float) -> list[LoopCycle]:
        """Cycles that ended between two times, s."""
        return [each for each in self.cycles if begin < each.reading.time <= end]


def rig(
    course: NominalCourse,
    hidden: HiddenTruth | None = None,
    *,
    steps: Sequence[LoopStep] | None = None,
    law: Callable[[Plant], ControlLaw[Any]] = lambda plant: LogPI(plant=plant),
    settings: LoopSettings | None = None,
    instrument: Instrument = DYNAMOMETER,
    source: Source | None = None,
    seed: int = 0,
    reading_period: float = 0.0,
    jitter: float = 0.0,
) -> Rig:
    """Everything plugged together; log-PI, and a dynamometer with noise, unless said."""
    bench = Instrumentation(dynamometer=Instrument(), power_meter=POWER_METER, seed=seed)
    bench = replace(bench, reading_period=reading_period, jitter=jitter)
    machine = ControlledMachine(course, HiddenTruth() if hidden is None else hidden, bench)
    sensor = Watched(machine, instrument, seed=seed)
    loop = Loop(
        sensor,
        machine,
        source=Dynamometer(10.0) if source is None else source,
        law=law,
        steps=[step(reference())] if steps is None else steps,
        preview=Preview(
            until=course.until,
            force=course.force,
            land_force=course.land_force,
            arcs=course.arcs,
        ),
        settings=LoopSettings(look_ahead=0) if settings is None else settings,
    )
    return Rig(machine=machine, sensor=sensor, loop=loop)
