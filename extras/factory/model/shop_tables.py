"""Tables of a shop file, as they are declared: keys, ranges, and what contradicts what.

Units are in the keys. A time is a number, or a table of a distribution.
"""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import Annotated

from extras.factory.model.calendar import calendar_of, moment
from extras.factory.model.distribution import Distribution, DistributionKind, constant
from extras.factory.model.interpolation import SettingRange, SettingsDesign
from extras.factory.model.shop import Counting, Failure, Maintenance
from extras.factory.model.states import HANDLING, MachineState
from simulator.files.toml_file import FileTable, KeyFault, quantity, require_whole
from stepnc_model.units import rev_s_from_rad_s, seconds_from_hours, seconds_from_minutes

Amount = Annotated[float, quantity(0, 1e9)]
Hours = Annotated[float, quantity(1e-4, 1e6, "h")]
WarmUp = Annotated[float, quantity(0, 1e6, "h")]
Power = Annotated[float, quantity(0, 1e6, "W")]
Share = Annotated[float, quantity(0, 1)]
Count = Annotated[float, quantity(1, 1e4)]
Capacity = Annotated[float, quantity(0, 1e6, "batches")]
BatchSize = Annotated[float, quantity(1, 1e6, "parts")]
Batches = Annotated[float, quantity(1, 1e9, "batches")]
Priority = Annotated[float, quantity(-1e6, 1e6)]
Variation = Annotated[float, quantity(0.001, 100)]
Shape = Annotated[float, quantity(0.1, 100)]

NEEDED = {
    DistributionKind.CONSTANT: ("mean",),
    DistributionKind.UNIFORM: ("low", "high"),
    DistributionKind.TRIANGULAR: ("low", "mode", "high"),
    DistributionKind.EXPONENTIAL: ("mean",),
    DistributionKind.GAMMA: ("mean", "variation"),
    DistributionKind.LOGNORMAL: ("mean", "variation"),
    DistributionKind.WEIBULL: ("mean", "shape"),
}
"""Keys of each kind of distribution."""

MOST_MACHINES = 10_000
"""Most machines of a shop."""

TASKS = frozenset({*HANDLING, MachineState.MACHINING, MachineState.REPAIR,
                   MachineState.MAINTENANCE})  # fmt: skip
"""States that may need a crew."""


class DistributionTable(FileTable, frozen=True, kw_only=True):
    """Table of a distribution, as ``{ kind = "exponential", mean = 90 }``."""

    kind: DistributionKind
    mean: Amount | None = None
    low: Amount | None = None
    mode: Amount | None = None
    high: Amount | None = None
    variation: Variation | None = None
    shape: Shape | None = None

    def __post_init__(self) -> None:
        needed = NEEDED[self.kind]
        for key in ("mean", "low", "mode", "high", "variation", "shape"):
            if key in needed and getattr(self, key) is None:
                raise KeyFault(key, f"missing; kind {self.kind} needs {', '.join(needed)}")
            if key not in needed and getattr(self, key) is not None:
                raise KeyFault(key, f"kind {self.kind} has only {', '.join(needed)}")
        ends = [(key, getattr(self, key)) for key in ("low", "mode", "high") if key in needed]
        for (key, value), (above, bound) in pairwise(ends):
            if value > bound:
                raise KeyFault(key, f"{value:g} exceeds {above} {bound:g}")

    @property
    def distribution(self) -> Distribution:
        """Distribution in the unit of its key."""
        return Distribution(
            kind=self.kind,
            low=self.low or 0.0,
            mode=self.mode or 0.0,
            high=self.high or 0.0,
            mean=self.mean or 0.0,
            variation=self.variation or 1.0,
            shape=self.shape or 1.0,
        )


Time = Amount | DistributionTable
"""Time of a file: a number or a distribution."""


class ShopHandlingTable(FileTable, frozen=True, kw_only=True):
    """Table ``[machine.handling]``: what replaces the machine file's times and powers."""

    batch_setup_s: Time | None = None
    batch_setup_w: Power | None = None
    part_setup_s: Time | None = None
    part_setup_w: Power | None = None
    part_ejection_s: Time | None = None
    part_ejection_w: Power | None = None
    batch_ejection_s: Time | None = None
    batch_ejection_w: Power | None = None


class FailureRow(FileTable, frozen=True, kw_only=True):
    """Row ``[[machine.failure]]``."""

    counts: Counting = Counting.MACHINING
    every_h: Time
    repair_min: Time
    scrap: Share = 0.0

    def __post_init__(self) -> None:
        if distribution_of(self.every_h).is_zero:
            raise KeyFault("every_h", "0 h: the machine would never work")

    @property
    def failure(self) -> Failure:
        """Failure in s."""
        return Failure(
            counts=self.counts,
            between=distribution_of(self.every_h).scaled(seconds_from_hours(1.0)),
            repair=distribution_of(self.repair_min).scaled(seconds_from_minutes(1.0)),
            scrap=self.scrap,
        )


class MaintenanceRow(FileTable, frozen=True, kw_only=True):
    """Row ``[[machine.maintenance]]``."""

    counts: Counting = Counting.MACHINING
    every_h: Hours
    takes_min: Time

    @property
    def maintenance(self) -> Maintenance:
        """Maintenance in s."""
        return Maintenance(
            counts=self.counts,
            every=seconds_from_hours(self.every_h),
            duration=distribution_of(self.takes_min).scaled(seconds_from_minutes(1.0)),
        )


class MachineRow(FileTable, frozen=True, kw_only=True):
    """Row ``[[machine]]``; with a count, machines NAME-1, NAME-2 and so on."""

    name: str
    machine: str = ""
    count: Count = 1.0
    shift: str = ""
    idle_power_w: Power | None = None
    handling: ShopHandlingTable = ShopHandlingTable()
    failure: tuple[FailureRow, ...] = ()
    maintenance: tuple[MaintenanceRow, ...] = ()

    def __post_init__(self) -> None:
        require_whole(self, "count")

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the machines of the row."""
        if self.count == 1:
            return (self.name,)
        return tuple(f"{self.name}-{number}" for number in range(1, int(self.count) + 1))


class ShiftRow(FileTable, frozen=True, kw_only=True):
    """Row ``[[shift]]``."""

    name: str
    hours: tuple[str, ...]

    def __post_init__(self) -> None:
        try:
            calendar_of(self.hours)
        except ValueError as error:
            raise KeyFault("hours", str(error)) from error


class CrewRow(FileTable, frozen=True, kw_only=True):
    """Row ``[[crew]]``; without machines it serves all."""

    name: str
    members: Count = 1.0
    tasks: tuple[MachineState, ...]
    machines: tuple[str, ...] = ()
    shift: str = ""

    def __post_init__(self) -> None:
        require_whole(self, "members")
        for task in self.tasks:
            if task not in TASKS:
                known = ", ".join(sorted(TASKS))
                raise KeyFault("tasks", f"'{task}' needs no crew; known: {known}")


class BufferRow(FileTable, frozen=True, kw_only=True):
    """Row ``[[buffer]]``; without a capacity it is unlimited."""

    name: str
    capacity: Capacity | None = None

    def __post_init__(self) -> None:
        if self.capacity is not None:
            require_whole(self, "capacity")


class VaryTable(FileTable, frozen=True, kw_only=True):
    """Table ``[product.step.vary]``: ranges of settings that are drawn for each part."""

    feed_mm_s: tuple[Annotated[float, quantity(0.001, 5_000, "mm/s")], ...] = ()
    spindle_rad_s: tuple[Annotated[float, quantity(0.1, 50_000, "rad/s")], ...] = ()
    depth_mm: tuple[Annotated[float, quantity(0.001, 1_000, "mm")], ...] = ()

    def __post_init__(self) -> None:
        for key in ("feed_mm_s", "spindle_rad_s", "depth_mm"):
            ends = getattr(self, key)
            if ends and (len(ends) != 2 or ends[0] > ends[1]):
                shown = ", ".join(f"{end:g}" for end in ends)
                raise KeyFault(key, f"[{shown}]: expected a lower and an upper bound")

    @property
    def design(self) -> SettingsDesign:
        """Ranges in canonical units."""
        turns = tuple(rev_s_from_rad_s(end) for end in self.spindle_rad_s)
        return SettingsDesign(
            feed=_range(self.feed_mm_s),
            spindle_speed=_range(turns),
            depth=_range(self.depth_mm),
        )


class StepRow(FileTable, frozen=True, kw_only=True):
    """Row ``[[product.step]]``: a program, or a time and a power."""

    machines: tuple[str, ...]
    program: str = ""
    time_s: Time | None = None
    power_w: Power = 0.0
    vary: VaryTable | None = None
    into: str = ""
    scrap: Share = 0.0

    def __post_init__(self) -> None:
        if bool(self.program) == (self.time_s is not None):
            raise KeyFault("program", "expected either a program or time_s")
        if not self.machines:
            raise KeyFault("machines", "empty; expected names of machines")
        if self.vary is not None and not self.program:
            raise KeyFault("vary", "expected together with a program")


class ProductRow(FileTable, frozen=True, kw_only=True):
    """Row ``[[product]]``."""

    name: str
    material: str = ""
    batch: BatchSize = 1.0
    batches: Batches | None = None
    arrival_min: Time | None = None
    priority: Priority = 0.0
    step: tuple[StepRow, ...]

    def __post_init__(self) -> None:
        require_whole(self, "batch")
        if self.batches is not None:
            require_whole(self, "batches")
        if not self.step:
            raise KeyFault("step", "missing; expected at least one [[product.step]]")
        if self.arrival_min is not None and distribution_of(self.arrival_min).is_zero:
            raise KeyFault("arrival_min", "0 min: leave it out for raw stock without end")


class ShopFile(FileTable, frozen=True, kw_only=True):
    """A whole shop file."""

    title: str = ""
    hours: Hours = 8.0
    warm_up_hours: WarmUp = 0.0
    start: str = "Mon 00:00"
    machine: tuple[MachineRow, ...]
    product: tuple[ProductRow, ...]
    buffer: tuple[BufferRow, ...] = ()
    shift: tuple[ShiftRow, ...] = ()
    crew: tuple[CrewRow, ...] = ()

    def __post_init__(self) -> None:
        try:
            moment(self.start)
        except ValueError as error:
            raise KeyFault("start", str(error)) from error
        if self.warm_up_hours >= self.hours:
            bound = f"the whole time of {self.hours:g} h"
            raise KeyFault("warm_up_hours", f"{self.warm_up_hours:g} h is not below {bound}")
        for key in ("machine", "product"):
            if not getattr(self, key):
                raise KeyFault(key, f"missing; expected at least one [[{key}]]")
        count = sum(int(row.count) for row in self.machine)
        if count > MOST_MACHINES:
            raise KeyFault("machine", f"{count} machines exceed {MOST_MACHINES}")
        machines = [name for row in self.machine for name in row.names]
        _require_once("machine", machines)
        for key in ("product", "buffer", "shift", "crew"):
            _require_once(key, [row.name for row in getattr(self, key)])
        self._require_known()
        self._require_exits()

    @property
    def groups(self) -> dict[str, tuple[str, ...]]:
        """Machines by the name of their row, and each by its own name."""
        own = {name: (name,) for row in self.machine for name in row.names}
        return own | {row.name: row.names for row in self.machine}

    def _require_known(self) -> None:
        """Refuse names that nothing in the file has."""
        groups = self.groups
        shifts = [row.name for row in self.shift]
        for row, machine in enumerate(self.machine, start=1):
            _require_in(f"machine[{row}].shift", machine.shift, shifts)
        for row, crew in enumerate(self.crew, start=1):
            _require_in(f"crew[{row}].shift", crew.shift, shifts)
            for name in crew.machines:
                _require_in(f"crew[{row}].machines", name, groups)
        buffers = [row.name for row in self.buffer]
        for row, product in enumerate(self.product, start=1):
            for at, step in enumerate(product.step, start=1):
                place = f"product[{row}].step[{at}]"
                for name in step.machines:
                    _require_in(f"{place}.machines", name, groups)
                _require_in(f"{place}.into", step.into, buffers)
                if at == len(product.step) and step.into:
                    raise KeyFault(f"{place}.into", "the last step has no buffer behind it")

    def _require_exits(self) -> None:
        """Refuse loops of machines without room for a batch: they block for ever."""
        capacity = {row.name: row.capacity for row in self.buffer}
        groups, onwards = self.groups, dict[str, set[str]]()
        for product in self.product:
            for step, following in pairwise(product.step):
                if capacity.get(step.into) != 0:
                    continue
                after = {name for group in following.machines for name in groups[group]}
                for group in step.machines:
                    for name in groups[group]:
                        onwards.setdefault(name, set()).update(after)
        loop = _loop(onwards)
        if loop:
            rows = [f"'{row.name}'" for row in self.buffer if row.capacity == 0]
            raise KeyFault(
                "buffer",
                f"capacity 0 of {', '.join(rows)} on the loop {' -> '.join(loop)}: no batch "
                "could leave it; expected at least 1 batch",
            )


def distribution_of(time: float | DistributionTable) -> Distribution:
    """Distribution of a time in the unit of its key."""
    return time.distribution if isinstance(time, DistributionTable) else constant(time)


def _range(ends: Sequence[float]) -> SettingRange | None:
    return SettingRange(low=ends[0], high=ends[1]) if ends else None


def _require_once(key: str, names: Sequence[str]) -> None:
    for name, times in Counter(names).items():
        if times > 1:
            raise KeyFault(key, f"'{name}' occurs {times} times")


def _require_in(key: str, name: str, known: Iterable[str]) -> None:
    if name and name not in set(known):
        raise KeyFault(key, f"unknown '{name}'; known: {', '.join(known) or 'none'}")


def _loop(onwards: Mapping[str, set[str]]) -> list[str]:
    """Names along a loop of a graph; empty if there is none."""
    done: set[str] = set()

    def visit(name: str, way: list[str]) -> list[str]:
        if name in way:
            return [*way[way.index(name) :], name]
        if name in done:
            return []
        for after in sorted(onwards.get(name, ())):
            if found := visit(after, [*way, name]):
                return found
        done.add(name)
        return []

    return next((found for name in sorted(onwards) if (found := visit(name, []))), [])
