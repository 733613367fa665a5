"""Observations of the machines of a live shop, for an MTConnect agent. Running state.

While a machine works on a program with fixed settings, its axes, spindle, feeds, force and
powers are those of the virtual machine at that moment of the part; powers are scaled by one
factor, so that they add up to the energy that was drawn for the part. Parts with drawn settings
and steps with times show their mean power, and no axes.

Timelines of parts: what the axes of a machine do while it machines a program.

A timeline is a run of the virtual machine with the settings as programmed, without deviation.
Parts whose settings are drawn have none.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from extras.agent.model.buffer import Value
from extras.agent.model.machine_feed import RunFeed, run_feed
from extras.factory.cycles import place_text
from extras.factory.devices import ShopDevices, first_values, state_values
from extras.factory.live import ShopView
from extras.factory.model.machining import MachiningPlan, Place
from extras.factory.model.records import Listeners, PartMade, StateSpent
from extras.factory.model.shop import Shop
from extras.factory.model.states import MachineState
from extras.factory.model.station import Station
from service.programs.machine_choice import material_for
from service.programs.reading import read_program
from service.progress import Tell, silent
from service.requests.runs import SimulationRequest
from service.simulation.run import machine_of
from service.simulation.setup import prepared_program
from simulator.machine.interpreter import interpret
from simulator.machine.samples import Samples, joined
from simulator.machine.sensing import Sampler
from simulator.spec import Machine, MaterialMatch
from stepnc_model.errors import StepNcError
from stepnc_model.programs.program import Program

FASTEST = 10.0
"""Highest rate of a timeline, in samples per simulated second."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PartTimeline:
    """Samples of the machining of a part."""

    samples: Samples
    workingsteps: Sequence[str]


def part_timelines(
    shop: Shop, plan: MachiningPlan, *, rate: float, tell: Tell
) -> Mapping[Place, PartTimeline]:
    """Run each program of a shop with fixed settings once on each kind of machine.

    Parameters
    ----------
    rate : float, 1/s
        Samples per simulated second, at most :data:`FASTEST`.

    Raises
    ------
    StepNcError
        When a program cannot be read or run.
    """
    known: dict[tuple[str, str, str], PartTimeline] = {}
    found: dict[Place, PartTimeline] = {}
    for place in plan.cycles:
        product, step, row = place
        spec = shop.machines[row].machine
        if spec is None:
            continue
        path = shop.products[product].steps[step].program
        key = (path, shop.products[product].material, spec.name)
        if key not in known:
            tell(f"timeline of {Path(path).name} on {spec.name}")
            program = read_program(Path(path), units="iso")
            material = material_for(shop.products[product].material, program)
            known[key] = part_timeline(program, spec, material, rate=min(rate, FASTEST))
        found[place] = known[key]
    return found


def part_timeline(
    program: Program, machine: Machine, material: MaterialMatch, *, rate: float
) -> PartTimeline:
    """Run a program with its own settings and return its samples.

    Raises
    ------
    StepNcError
        When the machine cannot run the program.
    """
    prepared = prepared_program(program, machine, material, tell=silent)
    virtual = machine_of(SimulationRequest(), prepared)
    sampler = Sampler(machine, rate=rate)
    try:
        parts = [
            samples
            for episode in virtual.run(interpret(prepared.blocks, machine))
            for samples in sampler.samples(episode)
        ]
    except StepNcError as error:
        raise StepNcError(f"{place_text(program, machine)}: {error}") from error
    return PartTimeline(samples=joined(parts), workingsteps=tuple(virtual.workingsteps))


DOWN = (MachineState.FAILED, MachineState.REPAIR)

AT_REST = (
    "xfrt", "yfrt", "zfrt", "feed", "speed", "cwatt", "xwatt", "ywatt", "zwatt", "cload",
    "cutforce", "coolwatt",
)  # fmt: skip
"""Short ids of data items that are 0 while a machine does not work."""

FROM_STATES = frozenset({"exec", "energy"})
"""Short ids of data items that the states of the shop give, not the timeline of the part."""

DIGITS = 3


@dataclass(slots=True, kw_only=True, eq=False)
class Cutting:
    """Timeline that a machine follows. Running state."""

    feed: RunFeed
    begin: float
    """Time at which the part would have begun without interruption, s."""
    factor: float
    """Factor on powers."""
    row: int = 0
    """Next observation."""


class ShopPublisher:
    """Turns what happens in a live shop into observations. Running state."""

    def __init__(
        self,
        shop: Shop,
        plan: MachiningPlan,
        devices: ShopDevices,
        timelines: Mapping[Place, PartTimeline],
    ) -> None:
        self._plan, self._devices = plan, devices
        self._feeds = _feeds(shop, devices, timelines)
        self._is_power = [item.type == "WATTAGE" for item in devices.model.items]
        count = len(shop.machines)
        self._before = [MachineState.IDLING] * count
        self._parts = [0] * count
        self._joules = [0.0] * count
        self._cutting: dict[int, Cutting] = {}
        self._held: dict[int, Value] = {}
        self._times: list[float] = []
        self._items: list[int] = []
        self._values: list[Value] = []
        self._view: ShopView | None = None

    @property
    def listeners(self) -> Listeners:
        """Functions that gather what happens."""
        return Listeners(part=(self._part,), state=(self._state,), began=(self._began,))

    def watch(self, view: ShopView) -> None:
        """Begin with the first values of a shop."""
        self._view = view
        for row, shown in enumerate(self._devices.shown):
            power = view.floor.stations[row].book.power
            own = first_values(shown, self._devices.names[row], power)
            self._tell(0.0, own)

    def taken(self, until: float) -> RunFeed:
        """Return observations up to a time in s, in the order of time, and forget them."""
        for row in list(self._cutting):
            self._follow(row, until)
        times = np.array(self._times)
        order = np.argsort(times, kind="stable")
        feed = RunFeed(
            items=np.array(self._items, dtype=np.int64)[order],
            times=times[order],
            values=[self._values[at] for at in order.tolist()],
        )
        self._times, self._items, self._values = [], [], []
        return feed

    def _began(self, row: int) -> None:
        view = self._view
        if view is None:
            return
        station = view.floor.stations[row]
        now, state = view.time, station.book.state
        self._follow(row, now)
        self._cutting.pop(row, None)
        if state not in DOWN:
            self._before[row] = state
        values = state_values(state, self._before[row])
        power: Value = None if state is MachineState.OFF else round(station.book.power, DIGITS)
        batch = station.held
        values |= {"watt": power, "program": view.program_of(station) or None}
        values |= {
            "batch": None if batch is None else str(batch.number),
            "part": None
            if batch is None or station.part is None
            else f"{batch.number}-{station.part}",
        }
        if state is MachineState.MACHINING:
            values |= self._follows(row, station, now)
        else:
            values |= {"basewatt": power, "workingstep": None}
            is_off = state is MachineState.OFF
            values |= dict.fromkeys(AT_REST, None if is_off else 0)
            values["coolant"] = None if is_off else "INACTIVE"
        self._tell_short(row, now, values)
        self._follow(row, now)

    def _follows(self, row: int, station: Station, now: float) -> dict[str, Value]:
        """Follow the timeline of the part; what is unknown without one."""
        batch, work = station.held, station.work
        place = None if batch is None else (batch.product, batch.step, row)
        feed = None if place is None else self._feeds.get(place)
        if feed is None or work is None or place is None:
            return dict.fromkeys(
                (*AT_REST, "basewatt", "coolant", "xpos", "ypos", "zpos"), None
            )
        energy = self._plan.cycles[place].cycle.energy
        begun = station.book.elapsed(now)
        self._cutting[row] = Cutting(
            feed=feed,
            begin=now - begun,
            factor=work.energy / energy if energy else 1.0,
            row=int(np.searchsorted(feed.times, begun, side="left")),
        )
        return {}

    def _follow(self, row: int, until: float) -> None:
        """Add the observations of the timeline up to a time."""
        cutting = self._cutting.get(row)
        if cutting is None:
            return
        feed = cutting.feed
        end = int(np.searchsorted(feed.times, until - cutting.begin, side="right"))
        for at in range(cutting.row, end):
            item, value = int(feed.items[at]), feed.values[at]
            if self._is_power[item] and isinstance(value, int | float):
                value = round(cutting.factor * value, DIGITS)
            self._add(cutting.begin + float(feed.times[at]), item, value)
        cutting.row = max(cutting.row, end)

    def _part(self, part: PartMade) -> None:
        self._parts[part.machine] += 1
        if self._view is not None:
            values: dict[str, Value] = {"parts": self._parts[part.machine]}
            self._tell_short(part.machine, self._view.time, values)

    def _state(self, spent: StateSpent) -> None:
        self._joules[spent.machine] += spent.energy
        energy = round(self._joules[spent.machine], 1)
        self._tell_short(spent.machine, spent.end, {"energy": energy})

    def _tell_short(self, row: int, time: float, values: Mapping[str, Value]) -> None:
        name = self._devices.names[row]
        self._tell(time, {f"{name}_{short}": value for short, value in values.items()})

    def _tell(self, time: float, values: Mapping[str, Value]) -> None:
        index = self._devices.model.index
        for id, value in values.items():
            if id in index:
                self._add(time, index[id], value)

    def _add(self, time: float, item: int, value: Value) -> None:
        """Add an observation that differs from the one before."""
        if item in self._held and self._held[item] == value:
            return
        self._held[item] = value
        self._times.append(time)
        self._items.append(item)
        self._values.append(value)


def _feeds(
    shop: Shop, devices: ShopDevices, timelines: Mapping[Place, PartTimeline]
) -> dict[Place, RunFeed]:
    """Timelines as observations of the devices of the shop, but for what states give."""
    found = {}
    for place, timeline in timelines.items():
        row = place[2]
        machine, shown = shop.machines[row].machine, devices.shown[row]
        if machine is None:
            continue
        spec = replace(machine, name=devices.names[row])
        feed = run_feed(timeline.samples, spec, shown, workingsteps=timeline.workingsteps)
        kept = {
            number: devices.model.index[shown.model.items[number].id]
            for number, item in shown.shown
            if item.id not in FROM_STATES
        }
        rows = [at for at, item in enumerate(feed.items.tolist()) if item in kept]
        found[place] = RunFeed(
            items=np.array([kept[int(feed.items[at])] for at in rows], dtype=np.int64),
            times=feed.times[rows],
            values=[feed.values[at] for at in rows],
        )
    return found
