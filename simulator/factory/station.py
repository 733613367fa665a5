"""A machine while a shop runs: a SimPy process that goes through the states of its chart.

Running state. A machine takes the batch of the highest priority that has waited longest, sets
it up, machines its parts one by one, ejects it, and offers it to the buffer behind. Shifts and
maintenance begin between two parts. A failure interrupts whatever the machine does; afterwards
it goes on where it stopped, unless the part is spoilt.
"""

from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import inf
from typing import Any, NamedTuple, TypeAlias

from simpy import Environment, Event, Interrupt, Process

from simulator.factory.crews import CrewOnDuty
from simulator.factory.machining import Machining
from simulator.factory.records import Listeners, PartMade, StateSpent
from simulator.factory.shop import Counting, Failure, Product, ShopMachine
from simulator.factory.states import HANDLING, TRANSITIONS, MachineState
from simulator.factory.store import Batch, BatchBuffer, Course, RawStock, oldest
from simulator.factory.streams import Streams

Steps: TypeAlias = frozenset[tuple[int, int]]
"""Indices of product and step."""


class Breakdown(NamedTuple):
    """Failure that interrupts a machine."""

    repair: float
    """s"""
    spoils: bool
    """Whether a part that is being machined is scrapped."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Surroundings:
    """What a machine meets in its shop."""

    products: Sequence[Product]
    supplies: Sequence[tuple[BatchBuffer, Steps]]
    """Buffers from which it takes batches, with the steps that it can do."""
    raw: Sequence[RawStock]
    """Raw stocks among them that never run out."""
    behind: Mapping[tuple[int, int], BatchBuffer]
    """Buffer behind each step; none behind the last."""
    machining: Mapping[tuple[int, int], Iterator[Machining]]
    """Machining of one part after another, by step."""
    crews: Mapping[MachineState, CrewOnDuty]
    """Crews by the states that need a member."""
    meter: "PowerMeter"
    finished: Callable[[Batch], None]
    """Called with each batch that leaves the shop."""
    started: Callable[[Batch], None]
    """Called with each batch that leaves the raw stock."""
    stuck: Callable[["Station"], None]
    """Called when the machine waits for room."""
    listeners: Listeners


@dataclass(slots=True, eq=False)
class PowerMeter:
    """Sum of the powers of all machines. Running state."""

    begin: float
    """Time from which the peak counts, s."""
    power: float = 0.0
    """W"""
    peak: float = 0.0
    """Greatest sum that lasted, W."""
    since: float = 0.0
    """Time of the last change, s."""

    def change(self, difference: float, now: float) -> None:
        """Add a difference; changes at one time count as one."""
        if now > self.since:
            if now > self.begin:
                self.peak = max(self.peak, self.power)
            self.since = now
        self.power += difference


@dataclass(slots=True, eq=False)
class PendingFailure:
    """Failure that counts machining time. Running state."""

    failure: Failure
    between: Iterator[float]
    repair: Iterator[float]
    spoils: Iterator[float]
    left: float = inf
    """Machining time until it comes, s."""


@dataclass(slots=True, eq=False)
class DueMaintenance:
    """Maintenance with the time until it is due. Running state."""

    counts: Counting
    every: float
    duration: Iterator[float]
    due: float
    """Machining time, or time, at which it is due, s."""


@dataclass(slots=True, eq=False)
class Station:
    """Machine of a running shop."""

    env: Environment
    index: int
    spec: ShopMachine
    around: Surroundings
    streams: Streams
    start: float = 0.0
    """Time of the week at which the run begins, s."""
    state: MachineState = MachineState.IDLING
    since: float = 0.0
    """Time at which the state began, s."""
    power: float = 0.0
    """Power in the state, W."""
    held: Batch | None = None
    """Batch on the machine."""
    holding_for: BatchBuffer | None = None
    """Buffer for whose room it waits."""
    part: int | None = None
    """Number of the part on the machine, in its batch."""
    work: Machining | None = None
    """Machining of the part, from its begin to its end."""
    cut: float = 0.0
    """Machining time of the part before the present state, s."""
    machined: float = 0.0
    """Machining time so far, s."""
    process: Process | None = None
    _asleep: Event | None = None
    _repaired: Event | None = None
    _machining_failures: list[PendingFailure] = field(default_factory=list)
    _clock_failures: list[PendingFailure] = field(default_factory=list)
    _maintenance: list[DueMaintenance] = field(default_factory=list)
    _times: dict[MachineState, Iterator[float]] = field(default_factory=dict)
    _scrap: Iterator[float] = field(init=False)
    _part_spoilt: bool = False
    _member_of: CrewOnDuty | None = None
    """Crew of which a member works at the machine."""

    def __post_init__(self) -> None:
        name, spec = self.spec.name, self.spec
        self.power = spec.idle_power
        for state in HANDLING:
            self._times[state] = self.streams.numbers(spec.handling[state].time, name, state)
        for row, failure in enumerate(spec.failures):
            purpose = f"failure {row}"
            pending = PendingFailure(
                failure=failure,
                between=self.streams.numbers(failure.between, name, purpose),
                repair=self.streams.numbers(failure.repair, name, f"{purpose} repair"),
                spoils=iter(self.streams.generator(name, f"{purpose} scrap").random, None),
            )
            if failure.counts is Counting.MACHINING:
                pending.left = next(pending.between)
                self._machining_failures.append(pending)
            else:
                self._clock_failures.append(pending)
        for row, each in enumerate(spec.maintenance):
            duration = self.streams.numbers(each.duration, name, f"maintenance {row}")
            self._maintenance.append(
                DueMaintenance(
                    counts=each.counts, every=each.every, duration=duration, due=each.every
                )
            )
        self._scrap = iter(self.streams.generator(name, "scrap").random, None)
        self.around.meter.change(self.power, self.env.now)
        self.process = self.env.process(self._run())
        for pending in self._clock_failures:
            self.env.process(self._fails_by_clock(pending))
        if spec.calendar is not None:
            self.env.process(self._changes_of_shift())
        for due in self._maintenance:
            if due.counts is Counting.CLOCK:
                self.env.process(self._wakes_when_due(due))

    # States

    def enter(self, state: MachineState, power: float) -> None:
        """Leave the present state for another.

        Raises
        ------
        RuntimeError
            If the transition is not legal.
        """
        if state not in TRANSITIONS[self.state]:
            raise RuntimeError(f"{self.spec.name}: no transition {self.state} -> {state}")
        self.close()
        if power != self.power:
            self.around.meter.change(power - self.power, self.env.now)
        self.state, self.power = state, power
        for tell in self.around.listeners.began:
            tell(self.index)

    def close(self) -> None:
        """Record the time in the present state so far."""
        now = self.env.now
        if self.state is MachineState.MACHINING:
            self.cut += now - self.since
        if now > self.since:
            energy = self.power * (now - self.since)
            spent = StateSpent(self.index, self.state, self.since, now, energy)
            for tell in self.around.listeners.state:
                tell(spent)
        self.since = now

    @property
    def elapsed(self) -> float:
        """Machining time of the part so far, s."""
        is_cutting = self.state is MachineState.MACHINING
        return self.cut + (self.env.now - self.since if is_cutting else 0.0)

    def wake(self) -> bool:
        """Wake the machine if it waits for a batch or its shift; whether it did."""
        if self._asleep is None:
            return False
        self._asleep.succeed()
        self._asleep = None
        return True

    def fail(self, repair: float, *, spoils: bool = False) -> bool:
        """Let the machine fail now; whether it could: not when it is off or already down.

        Parameters
        ----------
        repair : float, s
            Time of the repair.
        spoils : bool
            Whether a part that is being machined is scrapped.
        """
        can_fail = MachineState.FAILED in TRANSITIONS[self.state] and self._repaired is None
        if can_fail and self.process is not None:
            self._repaired = self.env.event()
            self.process.interrupt(Breakdown(repair, spoils))
        return can_fail

    # Course

    def _run(self) -> Course:
        while True:
            yield from self._between_parts()
            found = self._next_batch()
            if found is None:
                if self.state is not MachineState.STARVED:
                    self.enter(MachineState.STARVED, self.spec.idle_power)
                yield from self._sleep()
                continue
            yield from self._make(*found)

    def _next_batch(self) -> tuple[BatchBuffer, Batch] | None:
        for stock in self.around.raw:
            if not stock.buffer.items and stock.left > 0:
                stock.release()
        return oldest(self.around.supplies, lambda row: self.around.products[row].priority)

    def _make(self, buffer: BatchBuffer, batch: Batch) -> Course:
        """Machine a batch."""
        buffer.take(batch)
        if batch.step == 0:
            self.around.started(batch)
        self.held = batch
        step = (batch.product, batch.step)
        product = self.around.products[batch.product]
        scrap = product.steps[batch.step].scrap
        machining = self.around.machining[step]
        setup = yield from self._handle(MachineState.BATCH_SETUP)
        good: list[int] = []
        made: PartMade | None = None
        for row, part in enumerate(batch.parts):
            if row:
                yield from self._between_parts()
            self.part = part
            part_setup = yield from self._handle(MachineState.PART_SETUP)
            work = next(machining)
            yield from self._machine(work)
            ejection = yield from self._handle(MachineState.PART_EJECTION)
            is_good = not self._part_spoilt and (scrap == 0.0 or next(self._scrap) >= scrap)
            if is_good:
                good.append(part)
            if made is not None:
                self._tell(made)
            made = PartMade(
                self.index, *step, batch.number, part, self.env.now, 0.0 if row else setup,
                part_setup, work.time, ejection, 0.0, work.energy, work.peak_power,
                work.settings, is_good,
            )  # fmt: skip
        self.part = None
        ejection = yield from self._handle(MachineState.BATCH_EJECTION)
        if made is not None:
            self._tell(made._replace(batch_ejection=ejection))
        batch.parts = good
        yield from self._hand_over(batch, step)

    def _tell(self, made: PartMade) -> None:
        for tell in self.around.listeners.part:
            tell(made)

    def _hand_over(self, batch: Batch, step: tuple[int, int]) -> Course:
        """Move a batch on; wait where there is no room."""
        behind = self.around.behind.get(step)
        if behind is None or not batch.parts:
            self.around.finished(batch)
        else:
            batch.step += 1
            room = behind.put(batch)
            if room is not None:
                self.holding_for = behind
                self.enter(MachineState.BLOCKED, self.spec.idle_power)
                self.around.stuck(self)
                yield from self._until(room)
                self.holding_for = None
        self.held = None
        self.enter(MachineState.IDLING, self.spec.idle_power)

    def _handle(self, state: MachineState) -> Generator[Event, Any, float]:
        """Set up or eject, with a crew where the state needs one; the time that it took."""
        yield from self._claim(state)
        seconds = next(self._times[state])
        self.enter(state, self.spec.handling[state].power)
        if seconds > 0.0:
            yield from self._spend(seconds)
        self._release()
        return seconds

    def _machine(self, work: Machining) -> Course:
        """Machine a part, with the failures that come by machining time."""
        yield from self._claim(MachineState.MACHINING)
        power = work.energy / work.time if work.time > 0.0 else 0.0
        self._part_spoilt = False
        self.work, self.cut = work, 0.0
        self.enter(MachineState.MACHINING, power)
        left = work.time
        while self._machining_failures:
            first = min(self._machining_failures, key=lambda each: each.left)
            if first.left >= left:
                break
            spent = first.left
            yield from self._spend(spent)
            left -= spent
            self._age(spent)
            first.left = next(first.between)
            yield from self._down(Breakdown(next(first.repair), self._spoils(first)))
        yield from self._spend(left)
        self._age(left)
        self._release()
        self.work = None

    def _age(self, seconds: float) -> None:
        self.machined += seconds
        for each in self._machining_failures:
            each.left -= seconds

    def _claim(self, state: MachineState) -> Course:
        """Wait for a member of the crew that a state needs."""
        crew = self.around.crews.get(state)
        if crew is None:
            return
        member = crew.claim()
        if member is not None:
            self.enter(MachineState.WAITING, self.spec.idle_power)
            yield from self._until(member)
        self._member_of = crew

    def _release(self) -> None:
        if self._member_of is not None:
            self._member_of.release()
            self._member_of = None

    def _spend(self, seconds: float) -> Course:
        """Let time pass; what a failure interrupts goes on after the repair."""
        left = seconds
        while True:
            begin = self.env.now
            try:
                yield self.env.timeout(left)
            except Interrupt as interrupt:
                left -= self.env.now - begin
                yield from self._down(_breakdown(interrupt))
            else:
                return

    def _until(self, event: Event) -> Course:
        """Wait for an event, through failures."""
        while not event.processed:
            try:
                yield event
            except Interrupt as interrupt:
                yield from self._down(_breakdown(interrupt))

    def _sleep(self) -> Course:
        """Wait until the machine is woken."""
        self._asleep = self.env.event()
        yield from self._until(self._asleep)

    # Between parts: shift and maintenance

    def _between_parts(self) -> Course:
        while (due := self._due()) is not None or not self._is_open():
            if not self._is_open():
                if self.state is not MachineState.OFF:
                    self.enter(MachineState.OFF, 0.0)
                yield from self._sleep()
            elif due is not None:
                yield from self._maintain(due)

    def _is_open(self) -> bool:
        calendar = self.spec.calendar
        return calendar is None or calendar.is_open(self.start + self.env.now)

    def _due(self) -> DueMaintenance | None:
        for each in self._maintenance:
            counted = self.machined if each.counts is Counting.MACHINING else self.env.now
            if counted >= each.due:
                return each
        return None

    def _maintain(self, due: DueMaintenance) -> Course:
        yield from self._claim(MachineState.MAINTENANCE)
        self.enter(MachineState.MAINTENANCE, self.spec.idle_power)
        yield self.env.timeout(next(due.duration))
        self._release()
        counted = self.machined if due.counts is Counting.MACHINING else self.env.now
        due.due = counted + due.every
        for each in self._machining_failures:
            each.left = next(each.between)

    def _changes_of_shift(self) -> Course:
        """SimPy process that wakes the machine when its shift begins or ends."""
        calendar = self.spec.calendar
        while calendar is not None:
            now = self.start + self.env.now
            yield self.env.timeout(calendar.next_change(now) - now)
            self.wake()

    def _wakes_when_due(self, due: DueMaintenance) -> Course:
        """SimPy process that wakes a machine without work for its maintenance."""
        while True:
            yield self.env.timeout(max(due.due - self.env.now, 0.0) or due.every)
            self.wake()

    # Failures

    def _spoils(self, pending: PendingFailure) -> bool:
        share = pending.failure.scrap
        return share > 0.0 and next(pending.spoils) < share

    def _down(self, breakdown: Breakdown) -> Course:
        """Fail, and be repaired."""
        state, power = self.state, self.power
        self._repaired = self._repaired or self.env.event()
        self.enter(MachineState.FAILED, self.spec.idle_power)
        crew = self.around.crews.get(MachineState.REPAIR)
        if crew is self._member_of:
            crew = None
        member = None if crew is None else crew.claim()
        if member is not None:
            yield member
        self.enter(MachineState.REPAIR, self.spec.idle_power)
        yield self.env.timeout(breakdown.repair)
        if crew is not None:
            crew.release()
        self.enter(state, power)
        is_spoilt = breakdown.spoils and state is MachineState.MACHINING
        self._part_spoilt = self._part_spoilt or is_spoilt
        self._repaired.succeed()
        self._repaired = None

    def _fails_by_clock(self, pending: PendingFailure) -> Course:
        """SimPy process of failures that count all time."""
        while True:
            yield self.env.timeout(next(pending.between))
            self.fail(next(pending.repair), spoils=self._spoils(pending))
            if self._repaired is not None:
                yield self._repaired


def _breakdown(interrupt: Interrupt) -> Breakdown:
    """Failure of an interrupt, which only :meth:`Station.fail` causes."""
    cause = interrupt.cause
    if not isinstance(cause, Breakdown):
        raise TypeError(f"an interrupt of a machine by {cause!r}")
    return cause
