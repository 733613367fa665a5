"""State of a machine in a running shop, and what its states took so far. Running state."""

from array import array
from collections.abc import Callable
from dataclasses import dataclass, field

from extras.factory.model.passage import DrawnPart, PartTimes, Passage
from extras.factory.model.power_series import PowerSeries
from extras.factory.model.records import Listeners, StateSpent
from extras.factory.model.states import TRANSITIONS, MachineState
from extras.factory.model.tally import MachineTally

_PART_SETUP, _MACHINING, _PART_EJECTION = (
    MachineState.PART_SETUP, MachineState.MACHINING, MachineState.PART_EJECTION,
)  # fmt: skip
_BATCH_EJECTION = MachineState.BATCH_EJECTION


@dataclass(slots=True, eq=False)
class StateBook:
    """State of a machine, with times and energies of all its states."""

    index: int
    """Index of the machine."""
    name: str
    """Name of the machine."""
    tally: MachineTally
    series: PowerSeries
    listeners: Listeners
    power: float
    """Power in the state, W."""
    state: MachineState = MachineState.IDLING
    since: float = 0.0
    """Time until which it is recorded, s: the begin of the state, or a later look."""
    cut: float = 0.0
    """Machining time of the part before the present state, s."""
    is_heard: bool = field(init=False)
    """Whether anybody listens to the states."""
    _began: tuple[Callable[[int], None], ...] = field(init=False)
    _seconds: dict[MachineState, float] = field(init=False)
    _joules: dict[MachineState, float] = field(init=False)
    _spent: "array[float]" = field(init=False)

    def __post_init__(self) -> None:
        self._began = self.listeners.began
        self.is_heard = bool(self.listeners.state or self._began)
        self._seconds, self._joules = self.tally.seconds, self.tally.joules
        self._spent = self.series.waiting

    def enter(self, state: MachineState, power: float, now: float) -> None:
        """Leave the present state for another at a time in s.

        Raises
        ------
        RuntimeError
            If the transition is not legal.
        """
        if state not in TRANSITIONS[self.state]:
            raise RuntimeError(f"{self.name}: no transition {self.state} -> {state}")
        if now > self.since:
            self.record(now)
        self.state, self.power = state, power
        for begin in self._began:
            begin(self.index)

    def record(self, now: float) -> None:
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
        if self.is_heard:
            for tell in self.listeners.state:
                tell(StateSpent(self.index, state, since, now, energy))
            if state is _MACHINING:
                self.cut += spent

    def elapsed(self, now: float) -> float:
        """Machining time of the part until a time in s."""
        return self.cut + (now - self.since if self.state is _MACHINING else 0.0)

    def pass_part(self, part: DrawnPart, times: PartTimes, powers: tuple[float, float]) -> bool:
        """Record a part as entering its states one after another would.

        Parameters
        ----------
        powers : (float, float), W
            Of set-up and ejection.

        Returns
        -------
        bool
            False where somebody listens, the part was looked at or a state takes no time: then
            nothing is recorded.
        """
        begin, cutting, leaving, end = times
        if self.is_heard or not self.since == begin < cutting < leaving < end:
            return False
        setup, (time, energy, _, _), ejection = part
        setup_energy, ejection_energy = powers[0] * setup, powers[1] * ejection
        seconds, joules = self._seconds, self._joules
        seconds[_PART_SETUP] += setup
        seconds[_MACHINING] += time
        seconds[_PART_EJECTION] += ejection
        joules[_PART_SETUP] += setup_energy
        joules[_MACHINING] += energy
        joules[_PART_EJECTION] += ejection_energy
        self._spent.extend((
            begin, cutting, setup_energy, cutting, leaving, energy,
            leaving, end, ejection_energy,
        ))  # fmt: skip
        self.state, self.power, self.since = _PART_EJECTION, powers[1], end
        return True

    def pass_batch(self, passage: Passage, power: float) -> None:
        """Record a batch between its set-up and its ejection, whose power in W is given."""
        setup, ejection, machining, energy, _ = passage.totals
        powers = passage.powers
        self.record(passage.start)
        seconds, joules = self._seconds, self._joules
        seconds[_PART_SETUP] += setup
        seconds[_MACHINING] += machining
        seconds[_PART_EJECTION] += ejection
        joules[_PART_SETUP] += powers.setup * setup
        joules[_MACHINING] += energy
        joules[_PART_EJECTION] += powers.ejection * ejection
        self.series.add_batch(passage.start, passage.parts, powers)
        self.state, self.power, self.since = _BATCH_EJECTION, power, passage.end
