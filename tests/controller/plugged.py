"""What fits the sockets of the loop, for its tests: readings from a list, a port that notes."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from math import inf
from typing import Any

import numpy as np

from controller.cycle import LoopCycle
from controller.errors import MachineLost
from controller.laws.law import ControlLaw, Plant, Situation
from controller.loop import Loop
from controller.orders import EventKind, LoopEvent
from controller.reference import ForceBound, Reference
from controller.signals.ports import Reading, Sensor
from controller.signals.preview import Preview
from controller.signals.source import Dynamometer
from controller.states.loop_settings import LoopSettings, LoopStep
from optimiser.solver.problem import LimitName
from simulator.physics.tooth_means import Arcs

SPINDLE_SPEED = 50.0
"""rev/s"""

TEETH = 2
PERIOD = 1.0 / (SPINDLE_SPEED * TEETH)

SET_POINT = 400.0


def reading(force: float, **more: Any) -> Reading:
    """One tooth period of an even force in N; time and tooth are set by :class:`Told`."""
    values: dict[str, Any] = {
        "time": 0.0,
        "period": PERIOD,
        "force": np.full(8, force),
        "power": 1000.0,
        "feed": 10.0,
        "override": 1.0,
        "spindle_speed": SPINDLE_SPEED,
        "teeth": TEETH,
        "tooth": 0,
        "progress": 0.0,
        "workingstep": 1,
        "can_override": True,
    }
    return Reading(**(values | more))


class Told:
    """A sensor that tells what it was given, one tooth period after another. Running state.

    At the end the program has ended, or the machine is lost.
    """

    def __init__(self, readings: Iterable[Reading], *, is_lost: bool = False) -> None:
        self._readings: Iterator[Reading] = iter(readings)
        self._is_lost = is_lost
        self._count = 0

    def read(self) -> Reading | None:
        """See :class:`controller.signals.ports.Sensor`."""
        given = next(self._readings, None)
        if given is None:
            if self._is_lost:
                raise MachineLost("no answer")
            return None
        self._count += 1
        values = {name: getattr(given, name) for name in Reading._fields}
        time = self._count * PERIOD
        values |= {"time": time, "progress": time, "tooth": (self._count - 1) % given.teeth}
        return Reading(**values)


@dataclass(kw_only=True)
class Port:
    """An override that notes what it was set to. Running state."""

    overrides: list[float] = field(default_factory=list)

    def set(self, override: float, /) -> None:
        """See :class:`controller.signals.ports.Override`."""
        self.overrides.append(override)


@dataclass(frozen=True, slots=True, kw_only=True)
class Wishing:
    """A law that always wants the same, and notes what it was told."""

    wish: float
    told: list[Situation] = field(default_factory=list)

    def begin(self, _override: float) -> None:
        """See :class:`controller.laws.law.ControlLaw`."""

    def decide(self, state: None, at: Situation) -> tuple[None, float]:
        """See :class:`controller.laws.law.ControlLaw`."""
        self.told.append(at)
        return state, self.wish


ENTRY = np.full(1, 2.0)
"""rad, where the arc of contact begins everywhere"""


def step(**more: Any) -> LoopStep:
    """A workingstep with a set point of 400 N and a strength of 2000 N."""
    bound = ForceBound(name=LimitName.MOTOR_POWER, words="motor power", force=SET_POINT)
    values: dict[str, Any] = {"workingstep": "SLOT", "bounds": (bound,), "breakage": 2000.0}
    reference = Reference(**(values | more))
    return LoopStep(reference=reference, exponent=0.8, tool="mill", diameter=10.0)


@dataclass(kw_only=True)
class Plugged:
    """A loop with what it is plugged to. Running state."""

    loop: Loop
    port: Port
    cycles: list[LoopCycle] = field(default_factory=list)

    @property
    def kinds(self) -> list[EventKind]:
        """Of all events so far."""
        return [event.kind for event in self.events]

    @property
    def events(self) -> list[LoopEvent]:
        """All so far."""
        return [event for cycle in self.cycles for event in cycle.events]

    def run(self, count: float = inf) -> "Plugged":
        """So many cycles more, or to the end."""
        while count > 0:
            cycle = self.loop.cycle()
            if cycle is None:
                break
            self.cycles.append(cycle)
            count -= 1
        return self


def plugged(
    readings: Iterable[Reading],
    *,
    law: ControlLaw[Any] | Callable[[Plant], ControlLaw[Any]] = Wishing(wish=1.0),
    steps: Sequence[LoopStep] | None = None,
    settings: LoopSettings | None = None,
    sensor: Sensor | None = None,
    is_lost: bool = False,
) -> Plugged:
    """A loop on readings that are given."""
    port = Port()
    loop = Loop(
        Told(readings, is_lost=is_lost) if sensor is None else sensor,
        port,
        source=Dynamometer(10.0),
        law=law if callable(law) else lambda _plant: law,
        steps=[step()] if steps is None else steps,
        preview=Preview(
            until=np.array([1e6]),
            force=np.array([SET_POINT]),
            arcs=Arcs(entry_angle=ENTRY, exit_angle=ENTRY + 0.5, lag=np.zeros(1)),
        ),
        settings=LoopSettings(look_ahead=0) if settings is None else settings,
    )
    return Plugged(loop=loop, port=port)
