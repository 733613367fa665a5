"""A machine while a shop runs: a SimPy process that goes through the states of its chart.

Running state. A machine takes the batch of the highest priority that has waited longest, sets
it up, machines its parts one by one, ejects it, and offers it to the buffer behind. Shifts and
maintenance begin between two parts. A failure interrupts whatever the machine does; afterwards
it goes on where it stopped, unless the part is spoilt.
"""

from collections.abc import Generator, Iterator, Mapping
from dataclasses import dataclass, field
from math import inf
from typing import Any

from simpy import Environment, Event, Interrupt, Process

from extras.factory.model.crews import CrewOnDuty, changes_of_shift
from extras.factory.model.machining import Machining
from extras.factory.model.passage import (
    DrawnPart,
    PartTimes,
    Passage,
    PreparedParts,
    Step,
    drawn_parts,
    prepared_parts,
)
from extras.factory.model.records import PartMade
from extras.factory.model.shop import Counting, ShopMachine
from extras.factory.model.state_book import StateBook
from extras.factory.model.states import HANDLING, TRANSITIONS, MachineState
from extras.factory.model.store import Batch, BatchBuffer, Course, next_batch
from extras.factory.model.streams import Streams
from extras.factory.model.surroundings import Surroundings
from extras.factory.model.tally import MachineTally, ProcessTally
from extras.factory.model.upkeep import (
    Breakdown,
    DueMaintenance,
    PendingFailure,
    Upkeep,
    breakdown_of,
    upkeep_of,
    wakes_when_due,
)

# Names of the module: the attribute of an enumeration takes ten times as long.
_IDLING, _STARVED = MachineState.IDLING, MachineState.STARVED
_BATCH_SETUP, _BATCH_EJECTION = MachineState.BATCH_SETUP, MachineState.BATCH_EJECTION
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
    book: StateBook = field(init=False)
    held: Batch | None = None
    """Batch on the machine."""
    holding_for: BatchBuffer | None = None
    """Buffer for whose room it waits."""
    part: int | None = None
    """Number of the part on the machine, in its batch."""
    work: Machining | None = None
    """Machining of the part."""
    machined: float = 0.0
    """Machining time so far, s."""
    process: Process | None = None
    _counts: MachineTally = field(init=False)
    _passing: tuple[PartTimes, Machining] | None = None
    """Part that passes in one go."""
    _passage: Passage | None = None
    """Batch that passes in one go."""
    _is_plain: bool = False
    """Whether nothing can happen within a part, so that it passes in one go."""
    _has_crews: bool = False
    _has_pauses: bool = False
    """Whether shifts or maintenance may begin between two parts."""
    _powers: dict[MachineState, float] = field(default_factory=dict)
    asleep: Event | None = None
    """Event for which it waits without a batch or outside its shift."""
    _repaired: Event | None = None
    _upkeep: Upkeep = field(init=False)
    _times: dict[MachineState, Iterator[float]] = field(default_factory=dict)
    """Times of set-up and ejection of batches, s."""
    _parts: Mapping[Step, Iterator[DrawnPart]] = field(default_factory=dict)
    """Parts of each step, one after another."""
    _prepared: Mapping[Step, PreparedParts] = field(default_factory=dict)
    """The same, of a machine through which whole batches pass in one go."""
    _scrap: Iterator[float] = field(init=False)
    _part_spoilt: bool = False
    _member_of: CrewOnDuty | None = None
    """Crew of which a member works at the machine, or was asked for."""
    _member: Event | None = None
    """Event of the member that was asked for."""

    def __post_init__(self) -> None:
        name, spec = self.spec.name, self.spec
        tally, listeners = self.around.tally, self.around.listeners
        self._counts = tally.machines[self.index]
        self.book = StateBook(
            self.index, name, self._counts, tally.power, listeners, spec.idle_power
        )
        for step in self.around.machining:
            self._counts.processes[step] = ProcessTally()
        self._powers = {state: spec.handling[state].power for state in HANDLING}
        for state in (_BATCH_SETUP, _BATCH_EJECTION):
            self._times[state] = self.streams.numbers(spec.handling[state].time, name, state)
        self._upkeep = upkeep_of(spec, self.streams)
        self._has_crews = bool(self.around.crews)
        self._is_plain = not (self._has_crews or listeners.began or self._upkeep.by_clock)
        self._has_pauses = spec.calendar is not None or bool(self._upkeep.maintenance)
        if self._joins_parts():
            self._prepared = prepared_parts(spec, self.around.machining, self.streams)
        else:
            self._parts = drawn_parts(spec, self.around.machining, self.streams)
        self._scrap = iter(self.streams.generator(name, "scrap").random, None)
        self.process = self.env.process(self._run())
        for pending in self._upkeep.by_clock:
            self.env.process(self._fails_by_clock(pending))
        if spec.calendar is not None:
            self.env.process(changes_of_shift(self.env, spec.calendar, self.start, self.wake))
        for due in self._upkeep.maintenance:
            if due.counts is Counting.CLOCK:
                self.env.process(wakes_when_due(self.env, due, self.wake))

    def _joins_parts(self) -> bool:
        """True if whole batches pass in one event, as nobody can tell the difference.

        Who hears of states or parts hears of those of all machines in order. And where no time
        is random, machines are often ready at the same time, and go on in the order in which
        their last events began.
        """
        if not self._is_plain or self.book.is_heard or self._has_pauses:
            return False
        is_random = any(each.time.is_random for each in self.spec.handling.values())
        return not self.around.listeners.part and all(
            is_random or each.is_random for each in self.around.machining.values()
        )

    # States

    def close(self) -> None:
        """Record the time in the present state so far."""
        now = self.env.now
        if self._passing is not None:
            self._advance(*self._passing, now)
        if self._passage is not None:
            self._advance_batch(self._passage, now)
        self.book.record(now)

    def _advance(self, times: PartTimes, work: Machining, now: float) -> None:
        """Enter the states of a part that passes in one go, until a time in s."""
        book = self.book
        if book.state is _PART_SETUP and times.machining <= now:
            book.enter(_MACHINING, work.power, times.machining)
        if book.state is _MACHINING and times.ejection <= now:
            book.enter(_PART_EJECTION, self._powers[_PART_EJECTION], times.ejection)

    def _advance_batch(self, passage: Passage, now: float) -> None:
        """Enter the states of a batch that passes in one go, until a time in s."""
        if now < passage.start:
            return
        watched = passage.watch()
        while watched.ahead:
            part, times, work = watched.ahead[0]
            if now < times.setup:
                return
            if not watched.is_begun:
                self.book.enter(_PART_SETUP, self._powers[_PART_SETUP], times.setup)
                watched.is_begun = True
            self._advance(times, work, now)
            if now < times.end:
                return
            del watched.ahead[0]
            watched.is_begun = False
            self.machined += work.time
            watched.good += self._count(passage.step, [part], *work[:3])
        if passage.end <= now and self.book.state is not _BATCH_EJECTION:
            self.book.enter(_BATCH_EJECTION, self._powers[_BATCH_EJECTION], passage.end)

    def wake(self) -> bool:
        """Wake the machine if it waits for a batch or its shift; whether it did."""
        if self.asleep is None:
            return False
        self.asleep.succeed()
        self.asleep = None
        for buffer, _ in self.around.supplies:
            buffer.sleepers -= 1
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
        can_fail = (
            MachineState.FAILED in TRANSITIONS[self.book.state] and self._repaired is None
        )
        if can_fail and self.process is not None:
            self._repaired = self.env.event()
            self.process.interrupt(Breakdown(repair, spoils))
        return can_fail

    # Course

    def _run(self) -> Course:
        around = self.around
        while True:
            if self._has_pauses:
                yield from self._between_parts()
            batch = next_batch(around.raw, around.supplies, around.products)
            if batch is None:
                if self.book.state is not _STARVED:
                    self.book.enter(_STARVED, self.spec.idle_power, self.env.now)
                yield from self._sleep()
                continue
            if batch.step == 0:
                around.started(batch)
            self.held = batch
            step = (batch.product, batch.step)
            passage = self._prepared[step].take(batch) if self._prepared else None
            if passage is None:
                batch.parts = yield from self._make_parts(batch, step, self._parts[step])
            elif self.machined + passage.totals.machining <= self._upkeep.failure_at:
                yield self._begin_passage(passage)
                batch.parts = self._end_passage(passage)
            else:
                batch.parts = yield from self._make_parts(batch, step, passage.drawn())
            if (room := self._hand_over(batch, step)) is not None:
                yield from self._wait_for(room)
            self.held = None
            self.book.enter(_IDLING, self.spec.idle_power, self.env.now)

    def _begin_passage(self, passage: Passage) -> Event:
        """Let a batch pass in one event, which is returned."""
        now, times = self.env.now, self._times
        self.book.enter(_BATCH_SETUP, self._powers[_BATCH_SETUP], now)
        passage.begin(now + next(times[_BATCH_SETUP]))
        self._passage = passage
        return self.env.timeout(passage.end + next(times[_BATCH_EJECTION]) - now)

    def _end_passage(self, passage: Passage) -> list[int]:
        """Record a batch that has passed; the good parts."""
        self._passage = None
        if passage.watched is not None:
            self._advance_batch(passage, inf)
            return passage.watched.good
        _, _, time, energy, peak = passage.totals
        self.book.pass_batch(passage, self._powers[_BATCH_EJECTION])
        self.machined += time
        self.around.tally.power.flush_many()
        return self._count(passage.step, passage.batch.parts, time, energy, peak)

    def _count(
        self, step: Step, parts: list[int], time: float, energy: float, peak: float
    ) -> list[int]:
        """Count parts that have left the machine; the good ones."""
        good = [] if self._part_spoilt else parts
        scrap = self.around.products[step[0]].steps[step[1]].scrap
        if scrap:
            good = [part for part in good if next(self._scrap) >= scrap]
        self._part_spoilt = False
        self._counts.processes[step].add(len(parts), len(good), time, energy, peak)
        for tell in self.around.listeners.count:
            tell(len(parts), self.env.now)
        return good

    def _make_parts(
        self, batch: Batch, step: Step, parts: Iterator[DrawnPart]
    ) -> Generator[Event, Any, list[int]]:
        """Machine the parts of a batch one by one; the good ones."""
        good: list[int] = []
        made: PartMade | None = None
        batch_setup = next(self._times[_BATCH_SETUP])
        yield from self._handle(_BATCH_SETUP, batch_setup)
        for row, (part, drawn) in enumerate(zip(batch.parts, parts, strict=False)):
            if self._has_pauses and row:
                yield from self._between_parts()
            setup, work, ejection = drawn
            if self._is_plain and self.machined + work.time <= self._upkeep.failure_at:
                yield from self._pass_part(drawn)
            else:
                self.part, self.work, self.book.cut = part, work, 0.0
                yield from self._part(drawn)
            found = self._count(step, [part], *work[:3])
            self.around.tally.power.flush_many()
            good += found
            if self.around.listeners.part:
                if made is not None:
                    self._tell(made)
                made = PartMade(
                    self.index, *step, batch.number, part, self.env.now,
                    0.0 if row else batch_setup, setup, work.time, ejection, 0.0,
                    work.energy, work.peak_power, work.settings, bool(found),
                )  # fmt: skip
        self.part, self.work = None, None
        ejection = next(self._times[_BATCH_EJECTION])
        yield from self._handle(_BATCH_EJECTION, ejection)
        if made is not None:
            self._tell(made._replace(batch_ejection=ejection))
        return good

    def _pass_part(self, part: DrawnPart) -> Course:
        """Let a part pass in one event instead of three."""
        setup, work, ejection = part
        powers = self._powers[_PART_SETUP], self._powers[_PART_EJECTION]
        begin, whole = self.env.now, setup + work.time + ejection
        times = PartTimes(begin, begin + setup, begin + (whole - ejection), begin + whole)
        self.book.enter(_PART_SETUP, powers[0], begin)
        self._passing = times, work
        yield self.env.timeout(whole)
        self._passing = None
        if not self.book.pass_part(part, times, powers):
            self._advance(times, work, times.end)
        self.machined += work.time

    def _tell(self, made: PartMade) -> None:
        for tell in self.around.listeners.part:
            tell(made)

    def _hand_over(self, batch: Batch, step: Step) -> Event | None:
        """Move a batch on; the event for which it waits where there is no room."""
        behind = self.around.behind.get(step)
        if behind is None or not batch.parts:
            self.around.finished(batch)
            return None
        batch.step += 1
        room = behind.put(batch)
        if room is not None:
            self.holding_for = behind
        return room

    def _wait_for(self, room: Event) -> Course:
        """Wait for room in the buffer behind."""
        self.book.enter(MachineState.BLOCKED, self.spec.idle_power, self.env.now)
        self.around.stuck(self.index)
        yield from self._until(room)
        self.holding_for = None

    def _part(self, part: DrawnPart) -> Course:
        """Set up, machine and eject a part."""
        setup, work, ejection = part
        yield from self._handle(_PART_SETUP, setup)
        if self._has_crews:
            yield from self._claim(_MACHINING)
        yield from self._machine(work)
        if self._has_crews:
            self._release()
        yield from self._handle(_PART_EJECTION, ejection)

    def _handle(self, state: MachineState, seconds: float) -> Course:
        """Set up or eject, with a crew where the state needs one."""
        if self._has_crews:
            yield from self._claim(state)
        self.book.enter(state, self._powers[state], self.env.now)
        if self._is_plain:
            yield self.env.timeout(seconds)
        else:
            yield from self._spend(seconds)
            self._release()

    def _machine(self, work: Machining) -> Course:
        """Machine a part, with the failures that come by machining time."""
        seconds = work.time
        self._part_spoilt = False
        self.book.enter(_MACHINING, work.power, self.env.now)
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
            self.book.enter(MachineState.WAITING, self.spec.idle_power, self.env.now)
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
        for buffer, _ in self.around.supplies:
            buffer.sleepers += 1
        yield from self._until(self.asleep)

    # Between parts: shift and maintenance

    def _between_parts(self) -> Course:
        while (due := self._upkeep.due(self.machined, self.env.now)) or not self._is_open():
            if not self._is_open():
                if self.book.state is not MachineState.OFF:
                    self.book.enter(MachineState.OFF, 0.0, self.env.now)
                yield from self._sleep()
            elif due:
                yield from self._maintain(due)

    def _is_open(self) -> bool:
        calendar = self.spec.calendar
        return calendar is None or calendar.is_open(self.start + self.env.now)

    def _maintain(self, due: DueMaintenance) -> Course:
        yield from self._claim(MachineState.MAINTENANCE)
        self.book.enter(MachineState.MAINTENANCE, self.spec.idle_power, self.env.now)
        yield self.env.timeout(next(due.durations))
        self._release()
        self._upkeep.maintained(due, self.machined, self.env.now)

    # Failures

    def _down(self, breakdown: Breakdown) -> Course:
        """Fail, and be repaired."""
        state, power = self.book.state, self.book.power
        self._repaired = self._repaired or self.env.event()
        self.book.enter(MachineState.FAILED, self.spec.idle_power, self.env.now)
        crew = self.around.crews.get(MachineState.REPAIR)
        if crew is not None and crew is self._member_of:
            # One member is enough: who works here, or was asked for, repairs.
            crew, member = None, self._member
        else:
            member = None if crew is None else crew.claim()
        if member is not None and not member.processed:
            yield member
        self.book.enter(MachineState.REPAIR, self.spec.idle_power, self.env.now)
        yield self.env.timeout(breakdown.repair)
        if crew is not None:
            crew.release()
        self.book.enter(state, power, self.env.now)
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
