"""A machine while a shop runs: a SimPy process that goes through the states of its chart.

Running state. A machine takes the batch of the highest priority that has waited longest, sets
it up, machines its parts one by one, ejects it, and offers it to the buffer behind. Shifts and
maintenance begin between two parts. A failure interrupts whatever the machine does; afterwards
it goes on where it stopped, unless the part is spoilt.
"""

from array import array
from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, field
from typing import Any

from simpy import Environment, Event, Interrupt, Process

from simulator.factory.crews import CrewOnDuty
from simulator.factory.machining import Machining
from simulator.factory.records import PartMade, StateSpent
from simulator.factory.shifts import changes_of_shift
from simulator.factory.shop import Counting, ShopMachine
from simulator.factory.states import HANDLING, TRANSITIONS, MachineState
from simulator.factory.store import Batch, BatchBuffer, Course, oldest
from simulator.factory.streams import Streams
from simulator.factory.surroundings import Surroundings
from simulator.factory.tally import MachineTally, ProcessTally
from simulator.factory.upkeep import (
    Breakdown,
    DueMaintenance,
    PendingFailure,
    Upkeep,
    breakdown_of,
    upkeep_of,
    wakes_when_due,
)

WAITING = 3 * 2_000
"""Numbers of states whose energies are added to the power over time together."""

_PART_SETUP, _MACHINING, _PART_EJECTION = (
    MachineState.PART_SETUP, MachineState.MACHINING, MachineState.PART_EJECTION,
)  # fmt: skip


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
    """Machining of the part."""
    cut: float = 0.0
    """Machining time of the part before the present state, s."""
    machined: float = 0.0
    """Machining time so far, s."""
    process: Process | None = None
    _counts: MachineTally = field(init=False)
    _seconds: dict[MachineState, float] = field(init=False)
    _joules: dict[MachineState, float] = field(init=False)
    _spent: "array[float]" = field(init=False)
    _passing: tuple[float, float, Machining] | None = None
    """Begin of machining and of ejection, s, and work, of the part that passes in one go."""
    _is_plain: bool = False
    """Whether nothing can happen within a part, so that it passes in one go."""
    _listeners: tuple[Callable[[StateSpent], None], ...] = ()
    _began: tuple[Callable[[int], None], ...] = ()
    _is_heard: bool = False
    """Whether anybody listens to its states."""
    _has_crews: bool = False
    _has_pauses: bool = False
    """Whether shifts or maintenance may begin between two parts."""
    _powers: dict[MachineState, float] = field(default_factory=dict)
    asleep: Event | None = None
    """Event for which it waits without a batch or outside its shift."""
    _repaired: Event | None = None
    _upkeep: Upkeep = field(init=False)
    _times: dict[MachineState, Iterator[float]] = field(default_factory=dict)
    _scrap: Iterator[float] = field(init=False)
    _part_spoilt: bool = False
    _member_of: CrewOnDuty | None = None
    """Crew of which a member works at the machine, or was asked for."""
    _member: Event | None = None
    """Event of the member that was asked for."""

    def __post_init__(self) -> None:
        name, spec = self.spec.name, self.spec
        self.power = spec.idle_power
        tally = self.around.tally
        self._counts = tally.machines[self.index]
        self._seconds, self._joules = self._counts.seconds, self._counts.joules
        self._spent = tally.power.waiting
        self._listeners, self._began = self.around.listeners.state, self.around.listeners.began
        self._is_heard = bool(self._listeners or self._began)
        for step in self.around.machining:
            self._counts.processes[step] = ProcessTally()
        for state in HANDLING:
            self._times[state] = self.streams.numbers(spec.handling[state].time, name, state)
            self._powers[state] = spec.handling[state].power
        self._upkeep = upkeep_of(spec, self.streams)
        self._has_crews = bool(self.around.crews)
        self._is_plain = not (self._has_crews or self._began or self._upkeep.by_clock)
        self._has_pauses = spec.calendar is not None or bool(self._upkeep.maintenance)
        self._scrap = iter(self.streams.generator(name, "scrap").random, None)
        self.process = self.env.process(self._run())
        for pending in self._upkeep.by_clock:
            self.env.process(self._fails_by_clock(pending))
        if spec.calendar is not None:
            self.env.process(changes_of_shift(self.env, spec.calendar, self.start, self.wake))
        for due in self._upkeep.maintenance:
            if due.counts is Counting.CLOCK:
                self.env.process(wakes_when_due(self.env, due, self.wake))

    # States

    def enter(self, state: MachineState, power: float, now: float) -> None:
        """Leave the present state for another at a time in s.

        Raises
        ------
        RuntimeError
            If the transition is not legal.
        """
        if state not in TRANSITIONS[self.state]:
            raise RuntimeError(f"{self.spec.name}: no transition {self.state} -> {state}")
        self._record(now)
        self.state, self.power = state, power
        if self._is_heard:
            for begin in self._began:
                begin(self.index)

    def close(self) -> None:
        """Record the time in the present state so far."""
        self._advance(self.env.now)
        self._record(self.env.now)

    def _record(self, now: float) -> None:
        """Record the time in the present state until a time in s."""
        state, since = self.state, self.since
        if now <= since:
            return
        spent = now - since
        energy = self.power * spent
        self._seconds[state] += spent
        self._joules[state] += energy
        self._spent.extend((since, now, energy))
        self.since = now
        if self._is_heard:
            for tell in self._listeners:
                tell(StateSpent(self.index, state, since, now, energy))
            if state is _MACHINING:
                self.cut += spent

    def _advance(self, now: float) -> None:
        """Enter the states of a part that passes in one go, until a time in s."""
        if self._passing is None:
            return
        machining, ejection, work = self._passing
        if self.state is _PART_SETUP and machining <= now:
            self.enter(_MACHINING, _power(work), machining)
        if self.state is _MACHINING and ejection <= now:
            self.enter(_PART_EJECTION, self._powers[_PART_EJECTION], ejection)

    @property
    def elapsed(self) -> float:
        """Machining time of the part so far, s."""
        return self.cut + (self.env.now - self.since if self.state is _MACHINING else 0.0)

    def wake(self) -> bool:
        """Wake the machine if it waits for a batch or its shift; whether it did."""
        if self.asleep is None:
            return False
        self.asleep.succeed()
        self.asleep = None
        return True

    def fail(self, repair: float, *, spoils: bool = False) -> bool:
        """Let the machine fail now; whether it could: not when it is off or already down.

        Parameters
        ----------
        repair : float, s
            Time of the repair.
        spoils : bool
            Whether a part that is being machined is scrapped.

        Raises
        ------
        ValueError
            If no listener hears of states as they begin: such a machine is not interrupted.
        """
        if self._is_plain:
            raise ValueError(f"{self.spec.name} passes parts in one go: nobody listens")
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
                    self.enter(MachineState.STARVED, self.spec.idle_power, self.env.now)
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
        setup = yield from self._handle(MachineState.BATCH_SETUP)
        good, made = yield from self._make_parts(batch, step, setup)
        self.part, self.work = None, None
        ejection = yield from self._handle(MachineState.BATCH_EJECTION)
        if made is not None:
            self._tell(made._replace(batch_ejection=ejection))
        batch.parts = good
        yield from self._hand_over(batch, step)

    def _make_parts(  # noqa: PLR0912, PLR0915 (a call for each part is a tenth of its time)
        self, batch: Batch, step: tuple[int, int], batch_setup: float
    ) -> Generator[Event, Any, tuple[list[int], PartMade | None]]:
        """Machine the parts of a batch; the good ones, and the last that is yet to be told."""
        env, timeout, spent = self.env, self.env.timeout, self._spent
        seconds, joules = self._seconds, self._joules
        machining, process = self.around.machining[step], self._counts.processes[step]
        setups, ejections = self._times[_PART_SETUP], self._times[_PART_EJECTION]
        setup_power, ejection_power = self._powers[_PART_SETUP], self._powers[_PART_EJECTION]
        scrap = self.around.products[step[0]].steps[step[1]].scrap
        upkeep, is_plain, has_pauses = self._upkeep, self._is_plain, self._has_pauses
        has_listeners, is_heard = bool(self.around.listeners.part), self._is_heard
        good: list[int] = []
        made: PartMade | None = None
        # Whether the part before has just passed in one go, and when.
        follows, end = False, 0.0
        for row, part in enumerate(batch.parts):
            if has_pauses and row:
                yield from self._between_parts()
                follows = False
            work = next(machining)
            time, energy, peak, _ = work
            is_good, machined = True, self.machined + time
            if not is_plain or upkeep.failure_at < machined:
                self.part, self.work, self.cut = part, work, 0.0
                setup, ejection = yield from self._part(work)
                is_good, follows = not self._part_spoilt, False
            else:
                # Nobody looks and nothing interrupts: one event for the part instead of three.
                setup, ejection = next(setups), next(ejections)
                begin = end if follows else env.now
                whole = setup + time + ejection
                cutting, leaving, end = begin + setup, begin + (whole - ejection), begin + whole
                if follows:
                    self.state, self.power = _PART_SETUP, setup_power
                else:
                    self.enter(_PART_SETUP, setup_power, begin)
                self._passing = (cutting, leaving, work)
                yield timeout(whole)
                follows = not is_heard and self.since == begin < cutting < leaving < end
                if follows:
                    # As entering one after the other would.
                    setup_energy, ejection_energy = (
                        setup_power * setup,
                        ejection_power * ejection,
                    )
                    seconds[_PART_SETUP] += setup
                    seconds[_MACHINING] += time
                    seconds[_PART_EJECTION] += ejection
                    joules[_PART_SETUP] += setup_energy
                    joules[_MACHINING] += energy
                    joules[_PART_EJECTION] += ejection_energy
                    spent.extend((
                        begin, cutting, setup_energy, cutting, leaving, energy,
                        leaving, end, ejection_energy,
                    ))  # fmt: skip
                    self.state, self.power, self.since = _PART_EJECTION, ejection_power, end
                else:
                    self._advance(end)
                self._passing = None
                self.machined = machined
            if scrap and is_good:
                is_good = next(self._scrap) >= scrap
            if is_good:
                good.append(part)
            process.parts += 1
            process.good += is_good
            process.time += time
            process.energy += energy
            process.peak = max(process.peak, peak)
            if len(spent) > WAITING:
                self.around.tally.power.flush()
            if has_listeners:
                if made is not None:
                    self._tell(made)
                made = PartMade(
                    self.index, *step, batch.number, part, env.now, 0.0 if row else batch_setup,
                    setup, time, ejection, 0.0, energy, peak, work.settings, is_good,
                )  # fmt: skip
        return good, made

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
                self.enter(MachineState.BLOCKED, self.spec.idle_power, self.env.now)
                self.around.stuck(self.index)
                yield from self._until(room)
                self.holding_for = None
        self.held = None
        self.enter(MachineState.IDLING, self.spec.idle_power, self.env.now)

    def _part(self, work: Machining) -> Generator[Event, Any, tuple[float, float]]:
        """Set up, machine and eject a part; the times of set-up and ejection."""
        if self._has_crews:
            setup = yield from self._handle(MachineState.PART_SETUP)
            yield from self._claim(MachineState.MACHINING)
            yield from self._machine(work)
            self._release()
            ejection = yield from self._handle(MachineState.PART_EJECTION)
            return setup, ejection
        setup = yield from self._handle(MachineState.PART_SETUP)
        yield from self._machine(work)
        ejection = yield from self._handle(MachineState.PART_EJECTION)
        return setup, ejection

    def _handle(self, state: MachineState) -> Generator[Event, Any, float]:
        """Set up or eject, with a crew where the state needs one; the time that it took."""
        if self._has_crews:
            yield from self._claim(state)
        seconds = next(self._times[state])
        self.enter(state, self._powers[state], self.env.now)
        if self._is_plain:
            yield self.env.timeout(seconds)
        else:
            yield from self._spend(seconds)
            self._release()
        return seconds

    def _machine(self, work: Machining) -> Course:
        """Machine a part, with the failures that come by machining time."""
        seconds = work.time
        self._part_spoilt = False
        self.enter(_MACHINING, _power(work), self.env.now)
        while self._upkeep.failure_at < self.machined + seconds:
            before = self._upkeep.failure_at - self.machined
            yield from self._spend(before)
            self.machined += before
            seconds -= before
            yield from self._down(self._upkeep.breakdown(self.machined))
        yield from self._spend(seconds)
        self.machined += seconds

    def _claim(self, state: MachineState) -> Course:
        """Wait for a member of the crew that a state needs."""
        crew = self.around.crews.get(state)
        if crew is None:
            return
        self._member_of, self._member = crew, crew.claim()
        if self._member is not None:
            self.enter(MachineState.WAITING, self.spec.idle_power, self.env.now)
            yield from self._until(self._member)

    def _release(self) -> None:
        if self._member_of is not None:
            self._member_of.release()
            self._member_of = self._member = None

    def _spend(self, seconds: float) -> Course:
        """Let time pass, through failures."""
        end = self.env.now + seconds
        try:
            yield self.env.timeout(seconds)
        except Interrupt as interrupt:
            yield from self._interrupted(interrupt, end - self.env.now)

    def _interrupted(self, interrupt: Interrupt, left: float) -> Course:
        """Fail, and then let the time pass that was left."""
        yield from self._down(breakdown_of(interrupt))
        yield from self._spend(max(left, 0.0))

    def _until(self, event: Event) -> Course:
        """Wait for an event, through failures."""
        while not event.processed:
            try:
                yield event
            except Interrupt as interrupt:
                yield from self._down(breakdown_of(interrupt))

    def _sleep(self) -> Course:
        """Wait until the machine is woken."""
        self.asleep = self.env.event()
        yield from self._until(self.asleep)

    # Between parts: shift and maintenance

    def _between_parts(self) -> Course:
        while (due := self._due()) is not None or not self._is_open():
            if not self._is_open():
                if self.state is not MachineState.OFF:
                    self.enter(MachineState.OFF, 0.0, self.env.now)
                yield from self._sleep()
            elif due is not None:
                yield from self._maintain(due)

    def _is_open(self) -> bool:
        calendar = self.spec.calendar
        return calendar is None or calendar.is_open(self.start + self.env.now)

    def _due(self) -> DueMaintenance | None:
        return self._upkeep.due(self.machined, self.env.now)

    def _maintain(self, due: DueMaintenance) -> Course:
        yield from self._claim(MachineState.MAINTENANCE)
        self.enter(MachineState.MAINTENANCE, self.spec.idle_power, self.env.now)
        yield self.env.timeout(next(due.durations))
        self._release()
        self._upkeep.maintained(due, self.machined, self.env.now)

    # Failures

    def _down(self, breakdown: Breakdown) -> Course:
        """Fail, and be repaired."""
        state, power = self.state, self.power
        self._repaired = self._repaired or self.env.event()
        self.enter(MachineState.FAILED, self.spec.idle_power, self.env.now)
        crew = self.around.crews.get(MachineState.REPAIR)
        if crew is not None and crew is self._member_of:
            # One member is enough: who works here, or was asked for, repairs.
            crew, member = None, self._member
        else:
            member = None if crew is None else crew.claim()
        if member is not None and not member.processed:
            yield member
        self.enter(MachineState.REPAIR, self.spec.idle_power, self.env.now)
        yield self.env.timeout(breakdown.repair)
        if crew is not None:
            crew.release()
        self.enter(state, power, self.env.now)
        is_spoilt = breakdown.spoils and state is MachineState.MACHINING
        self._part_spoilt = self._part_spoilt or is_spoilt
        self._repaired.succeed()
        self._repaired = None

    def _fails_by_clock(self, pending: PendingFailure) -> Course:
        """SimPy process of failures that count all time."""
        while True:
            yield self.env.timeout(next(pending.between))
            breakdown = pending.breakdown()
            self.fail(breakdown.repair, spoils=breakdown.spoils)
            if self._repaired is not None:
                yield self._repaired


def _power(work: Machining) -> float:
    """Mean power of machining, W."""
    return work.energy / work.time if work.time > 0.0 else 0.0
