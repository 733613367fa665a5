"""A shop as its file describes it: machines, buffers, crews, products and their routes.

Units s, W, parts and batches. All machines of a product's step are alternatives; whole batches
move on from step to step.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

from extras.factory.model.calendar import Calendar
from extras.factory.model.distribution import Distribution
from extras.factory.model.interpolation import SettingsDesign
from extras.factory.model.states import MachineState
from simulator.spec import Machine


class Counting(StrEnum):
    """Time that counts towards a failure or a maintenance."""

    MACHINING = "machining"
    """Time in which the machine cuts."""
    CLOCK = "clock"
    """All time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StateLoad:
    """Time and power of a state."""

    time: Distribution
    """s"""
    power: float
    """Total power of the machine, W."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Failure:
    """Way in which a machine fails."""

    counts: Counting
    between: Distribution
    """Time from a repair, or a maintenance, to the next failure, s."""
    repair: Distribution
    """s"""
    scrap: float = 0.0
    """Share of failures that spoil the part on the machine."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Maintenance:
    """Preventive maintenance, done between two parts; failures count anew after it."""

    counts: Counting
    every: float
    """s"""
    duration: Distribution
    """s"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ShopMachine:
    """Machine in a shop."""

    name: str
    machine: Machine | None
    """Machine of the library; None: only times are known."""
    handling: Mapping[MachineState, StateLoad]
    """Times and powers of set-up and ejection."""
    idle_power: float = 0.0
    """Power while the machine waits or is down, W."""
    calendar: Calendar | None = None
    """Working hours; None: always."""
    failures: tuple[Failure, ...] = ()
    maintenance: tuple[Maintenance, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Crew:
    """Crew whose members serve machines, one member a task."""

    name: str
    members: int
    tasks: frozenset[MachineState]
    """States that need a member."""
    machines: frozenset[str]
    """Machines that the crew serves."""
    calendar: Calendar | None = None
    """Working hours; a task that was begun is finished. None: always."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Buffer:
    """Place where batches wait between two steps."""

    name: str
    capacity: int | None = None
    """Batches; 0: batches pass from machine to machine. None: unlimited."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RouteStep:
    """Step of a route: a program, or a time, on one of several machines."""

    machines: tuple[str, ...]
    program: str = ""
    """STEP-NC program; empty: only its time is known."""
    load: StateLoad | None = None
    """Time and power of machining where there is no program."""
    design: SettingsDesign | None = None
    """Settings that are drawn uniformly for each part; None: as programmed."""
    into: str = ""
    """Buffer behind the step; empty behind the last."""
    scrap: float = 0.0
    """Share of parts that are scrapped."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Product:
    """Product that the shop makes in batches."""

    name: str
    material: str
    """Work material; empty: as the programs name it."""
    batch: int
    """Parts of a batch."""
    batches: int | None
    """Batches that are ordered; None: without end."""
    arrival: Distribution | None
    """Time between the arrivals of two batches, s; None: raw stock never runs out."""
    steps: tuple[RouteStep, ...]
    priority: float = 0.0
    """Machines take batches of higher priority first, then the one that has waited longest."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Shop:
    """A shop."""

    title: str
    machines: tuple[ShopMachine, ...]
    products: tuple[Product, ...]
    buffers: tuple[Buffer, ...]
    crews: tuple[Crew, ...] = ()
    duration: float
    """Simulated time, s."""
    warm_up: float = 0.0
    """Time at the beginning that does not count, s."""
    start: float = 0.0
    """Time of the week at which the run begins, s since Monday, 0:00."""
