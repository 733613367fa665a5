"""A running shop: its machines, buffers and crews on one SimPy clock. Running state."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import count
from math import inf

from simpy import Environment, Event

from extras.factory.model.crews import CrewOnDuty, changes_of_shift
from extras.factory.model.machining import MachiningPlan, PartSource
from extras.factory.model.records import Listeners
from extras.factory.model.shop import Shop
from extras.factory.model.states import MachineState
from extras.factory.model.station import Station
from extras.factory.model.store import Batch, BatchBuffer, RawStock
from extras.factory.model.streams import Streams
from extras.factory.model.surroundings import Steps, Surroundings
from extras.factory.model.tally import Tally
from simulator.errors import Deadlock

_STARVED = MachineState.STARVED


@dataclass(slots=True, eq=False)
class Floor:
    """Shop in operation."""

    shop: Shop
    machining: MachiningPlan
    streams: Streams
    listeners: Listeners
    env: Environment = field(default_factory=Environment)
    stations: list[Station] = field(default_factory=list)
    buffers: dict[str, BatchBuffer] = field(default_factory=dict)
    raw: list[RawStock] = field(default_factory=list)
    tally: Tally = field(init=False)
    in_shop: int = 0
    """Batches that entered the shop and have not left it."""
    _takers: dict[int, list[Station]] = field(default_factory=dict)
    """Machines that take from a buffer, by its identity."""
    _end: Event = field(init=False)
    _deadlock: Deadlock | None = None

    def __post_init__(self) -> None:
        shop = self.shop
        self.tally = Tally(shop)
        self._end = self.env.event()
        for each in shop.buffers:
            capacity = inf if each.capacity is None else each.capacity
            self.buffers[each.name] = self._buffer(each.name, capacity)
        numbers = count()
        for row, product in enumerate(shop.products):
            buffer = self._buffer(f"raw stock of {product.name}", inf)
            self.raw.append(RawStock(buffer, product, row, numbers, entered=self._entered))
        crews = [CrewOnDuty(self.env, crew, shop.start) for crew in shop.crews]
        for on_duty in crews:
            if (calendar := on_duty.crew.calendar) is not None:
                self.env.process(
                    changes_of_shift(self.env, calendar, shop.start, on_duty.serve)
                )
        for index in range(len(shop.machines)):
            self.stations.append(self._station(index, crews))
        for stock in self.raw:
            if stock.product.arrival is not None:
                intervals = self.streams.numbers(
                    stock.product.arrival, stock.product.name, "arrival"
                )
                self.env.process(stock.arrivals(intervals))

    def run(self, until: float) -> None:
        """Run until a time in s, or until all orders are finished.

        Raises
        ------
        Deadlock
            If machines wait for each other.
        """
        warm_up = self.shop.warm_up
        if self.env.now < warm_up <= until:
            self._run(warm_up)
            self.close()
            self.tally.reset(self.env.now)
            for buffer in self.buffers.values():
                buffer.area = 0.0
        self._run(until)

    def _run(self, until: float) -> None:
        if self._end.triggered or until <= self.env.now:
            return
        self.env.run(until=self._end | self.env.timeout(until - self.env.now))
        if self._deadlock is not None:
            raise self._deadlock

    @property
    def is_finished(self) -> bool:
        """True if all orders are finished."""
        return self._end.triggered and self._deadlock is None

    def close(self) -> None:
        """Record the states so far."""
        for station in self.stations:
            station.close()
        for buffer in self.buffers.values():
            buffer.close()
        self.tally.close(self.env.now)

    def _buffer(self, name: str, capacity: float) -> BatchBuffer:
        return BatchBuffer(self.env, name, capacity, self._wake_taker)

    def _station(self, index: int, crews: Sequence[CrewOnDuty]) -> Station:
        shop, spec = self.shop, self.shop.machines[index]
        behind: dict[tuple[int, int], BatchBuffer] = {}
        machining: dict[tuple[int, int], PartSource] = {}
        steps: dict[str, set[tuple[int, int]]] = {}
        raw: list[RawStock] = []
        supplies: list[tuple[BatchBuffer, Steps]] = []
        for row, product in enumerate(shop.products):
            for at, step in enumerate(product.steps):
                if spec.name not in step.machines:
                    continue
                machining[row, at] = self.machining.parts(shop, (row, at, index), self.streams)
                if step.into:
                    behind[row, at] = self.buffers[step.into]
                if at:
                    steps.setdefault(product.steps[at - 1].into, set()).add((row, at))
                else:
                    supplies.append((self.raw[row].buffer, frozenset({(row, 0)})))
                    if self.raw[row].is_endless:
                        raw.append(self.raw[row])
        supplies += [(self.buffers[name], frozenset(found)) for name, found in steps.items()]
        station = Station(
            self.env,
            index,
            spec,
            Surroundings(
                products=shop.products,
                supplies=supplies,
                raw=raw,
                behind=behind,
                machining=machining,
                crews=_crews_of(spec.name, crews),
                tally=self.tally,
                started=self._started,
                finished=self._finished,
                stuck=self._require_movement,
                listeners=self.listeners,
            ),
            self.streams,
            shop.start,
        )
        for buffer, _ in supplies:
            self._takers.setdefault(id(buffer), []).append(station)
        return station

    def _wake_taker(self, buffer: BatchBuffer) -> None:
        """Wake the machine that has waited longest for a batch."""
        takers = [each for each in self._takers.get(id(buffer), ()) if each.asleep is not None]
        starved = [each for each in takers if each.book.state is _STARVED]
        if starved:
            min(starved, key=lambda station: station.book.since).wake()
        elif takers:
            # Off shift: it looks whether it may begin.
            takers[0].wake()

    def _entered(self, batch: Batch) -> None:
        self.in_shop += 1
        self.tally.entered(batch)
        for tell in self.listeners.entered:
            tell(batch)

    def _started(self, batch: Batch) -> None:
        """Let a batch of endless raw stock enter as a machine takes it."""
        if self.raw[batch.product].is_endless:
            batch.released = self.env.now
            self._entered(batch)

    def _finished(self, batch: Batch) -> None:
        self.tally.left(batch, self.env.now)
        for tell in self.listeners.left:
            tell(batch, self.env.now)
        self.in_shop -= 1
        is_over = not self.in_shop and not any(
            stock.left or stock.buffer.items for stock in self.raw
        )
        if is_over and not self._end.triggered:
            self._end.succeed()

    def _require_movement(self, index: int) -> None:
        """End the run where a machine can never hand over its batch."""
        station = self.stations[index]
        found: dict[int, Station] = {}
        if not self._can_move(station, found) and not self._end.triggered:
            # Raised by `run`, as SimPy makes exceptions of processes anew.
            waits = [self._waits(each) for each in found.values()]
            self._deadlock = Deadlock(waits, self.env.now)
            self._end.succeed()

    def _can_move(self, station: Station, seen: dict[int, Station]) -> bool:
        """True if a machine will give its batch away, as others take what it waits for."""
        buffer = station.holding_for
        if buffer is None or station.held is None or station.held.offered is None:
            return True
        if station.index in seen:
            return False
        seen[station.index] = station
        wanted = {(batch.product, batch.step) for batch in buffer.items}
        takers = [
            each
            for each in self._takers.get(id(buffer), ())
            if any(wanted & steps for store, steps in each.around.supplies if store is buffer)
        ]
        return any(self._can_move(each, seen) for each in takers)

    def _waits(self, station: Station) -> str:
        """Reason why a machine is blocked, in words."""
        buffer, batch = station.holding_for, station.held
        if buffer is None or batch is None:
            return station.spec.name
        product = self.shop.products[batch.product].name
        takers = ", ".join(each.spec.name for each in self._takers.get(id(buffer), ()))
        return (
            f"{station.spec.name} holds batch {batch.number} of {product} for '{buffer.name}' "
            f"({buffer.level} of {buffer.capacity:g} batches), which {takers} must empty"
        )


def _crews_of(name: str, crews: Sequence[CrewOnDuty]) -> Mapping[MachineState, CrewOnDuty]:
    """Crews that serve a machine, by state."""
    return {
        state: each for each in crews if name in each.crew.machines for state in each.crew.tasks
    }
