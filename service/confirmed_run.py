"""Run of an advised program beside the program as given, workingstep by workingstep.

The advised program runs once. Its loads are added up twice, with the nominal k_c and with that
at the quantile of the plan, for neither motion nor removal depend on k_c. Of the program as
given only the stock is followed: after each workingstep, what both have left is compared.
"""

from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import chain

from optimiser.advice import Plan
from service.reading import Tell, silent
from service.requests.runs import SimulationRequest
from service.simulation.gathering import require_sense
from service.simulation.run import machine_of
from service.simulation.setup import PreparedRun, prepared_program
from simulator.machine.acts import ProgramAct, WorkingstepTo
from simulator.machine.interpreter import interpret
from simulator.machine.samples import Episode
from simulator.machine.totals import Total, added
from simulator.machine.virtual import StockMap
from simulator.removal.difference import StockDifference, bar_difference, height_difference
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import BarRadii, TurningStock
from simulator.removal.stations import stretch_lengths
from simulator.spec import Machine, MaterialMatch
from stepnc_model.program import Program


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceScale:
    """Factors on the k_c of the library for one workingstep."""

    nominal: float = 1.0
    """Accepted correction."""
    quantile: float = 1.0
    """k_c at the quantile of the plan."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ConfirmedTotals:
    """Totals of one workingstep, and the stock that it leaves."""

    id: str
    nominal: Total
    quantile: Total
    volume: float = 0.0
    """Volume that its path removes from the stock, mm³."""
    left: StockDifference | None = None
    """Stock left, compared with that of the program as given; None where it is unknown."""


def confirmed_totals(
    plan: Plan, given: Program, advised: Program, *, tell: Tell = silent
) -> tuple[ConfirmedTotals, ...]:
    """Totals of all workingsteps of an advised program, in order of execution.

    Raises
    ------
    StepNcError
        When the machine cannot run one of the programs.
    """
    machine, material = plan.machine, plan.material
    scales = {
        advice.workingstep.index: ForceScale(
            nominal=advice.force_factor, quantile=advice.force_factor * advice.safety_factor
        )
        for advice in plan.advices
    }
    resolutions = {
        advice.workingstep.index: advice.cut.resolution
        for advice in plan.advices
        if advice.cut is not None
    }
    beside = _GivenRun(given, machine, material)
    prepared = prepared_program(advised, machine, material, tell=tell)
    virtual = machine_of(SimulationRequest(), prepared)
    left: list[StockDifference | None] = []

    def compare() -> None:
        beside.advance()
        if virtual.workingsteps:
            stock = prepared.stock(virtual.workingsteps[-1])
            within = resolutions.get(len(left), 0.0)
            left.append(_difference(stock, beside.stock, within))

    acts = _watched(interpret(prepared.blocks, machine), compare)
    totals = _LoadTotals(machine, scales)
    for episode in virtual.run(acts):
        totals.add(episode)
    return tuple(
        ConfirmedTotals(
            id=name,
            nominal=totals.nominal[at],
            quantile=totals.quantile[at],
            volume=totals.volume[at],
            left=left[at],
        )
        for at, name in enumerate(virtual.workingsteps)
    )


def _watched(acts: Iterator[ProgramAct], at_end: Callable[[], None]) -> Iterator[ProgramAct]:
    """Acts of a program; calls a function when all acts of a workingstep have been done."""
    for act in acts:
        if isinstance(act.act, WorkingstepTo):
            at_end()
        yield act
    at_end()


class _LoadTotals:
    """Totals by workingstep, counted from 0, with two values of k_c (mutable state)."""

    def __init__(self, machine: Machine, scales: dict[int, ForceScale]) -> None:
        self.nominal: defaultdict[int, Total] = defaultdict(Total)
        self.quantile: defaultdict[int, Total] = defaultdict(Total)
        self.volume: defaultdict[int, float] = defaultdict(float)
        self._machine = machine
        self._scales = scales

    def add(self, episode: Episode) -> None:
        """Add an episode of the run."""
        require_sense(episode)
        at = episode.state.workingstep - 1
        scale = self._scales.get(at, ForceScale())
        for totals, factor in (
            (self.nominal, scale.nominal),
            (self.quantile, scale.quantile),
        ):
            totals[at] = added(totals[at], _scaled(episode, factor), self._machine)
        if episode.course is not None:
            stations = episode.course.stations
            self.volume[at] += float((stations.section * stretch_lengths(stations)).sum())


def _scaled(episode: Episode, factor: float) -> Episode:
    """Episode with another k_c."""
    course = episode.course
    if factor == 1.0 or course is None or course.edge is None:
        return episode
    edge = replace(course.edge, factor=factor * course.edge.factor)
    return replace(episode, course=replace(course, edge=edge))


class _GivenRun:
    """Program as given, run for the stock that it leaves (mutable state)."""

    def __init__(self, program: Program, machine: Machine, material: MaterialMatch) -> None:
        self._prepared: PreparedRun = prepared_program(program, machine, material, tell=silent)
        self._virtual = machine_of(SimulationRequest(), self._prepared)
        self._acts = interpret(self._prepared.blocks, machine)
        self._next: ProgramAct | None = None

    @property
    def stock(self) -> StockMap | None:
        """Stock of the workingstep that was run last, as it left it."""
        return self._prepared.stock(self._virtual.workingsteps[-1])

    def advance(self) -> None:
        """Run until the next workingstep begins, or to the end."""
        for _ in self._virtual.run(self._piece()):
            pass

    def _piece(self) -> Iterator[ProgramAct]:
        """Acts up to the beginning of the next workingstep."""
        first = () if self._next is None else (self._next,)
        self._next = None
        for count, act in enumerate(chain(first, self._acts)):
            if isinstance(act.act, WorkingstepTo) and (count or not first):
                self._next = act
                return
            yield act


def _difference(
    one: StockMap | None, other: StockMap | None, within: float
) -> StockDifference | None:
    """Difference of two stocks within the resolution of both the plan's map and theirs."""
    match one, other:
        case MillingStock(map=map_), MillingStock(map=wanted):
            cells = map_.grid.dx, map_.grid.dy
            return height_difference(
                map_.grid.heights,
                wanted.grid.heights,
                cells=cells,
                within=max(within, map_.cell),
            )
        case TurningStock(cell=cell), TurningStock():
            bars = (BarRadii(outer=each.outer, inner=each.inner) for each in (one, other))
            return bar_difference(*bars, cell=cell, within=max(within, cell))
    return None
