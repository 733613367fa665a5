"""Comparison of a plan with its simulated run: the predictions of ``optimise`` against results.

Both sides define each figure alike: time on the path itself, without tool change and approach;
cutting force as the mean over a revolution, plunges excluded; thrust along the axis of drills
and plunges; cutting power at the edge; drive power while there are chips.

Figures are compared with the nominal k_c, bounds with that at the quantile of the plan.

Run of an advised program beside the program as given, workingstep by workingstep.

The advised program runs once. Its loads are added up twice, with the nominal k_c and with that
at the quantile of the plan, for neither motion nor removal depend on k_c. Of the program as
given only the stock is followed: after each workingstep, what both have left is compared.
"""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import chain
from math import inf, pi

from optimiser.advice import Advice, AdviceStatus, EvaluatedSetting, LimitLoad, Plan
from optimiser.cuts.cut import Cut, CutKind, PowerPlace, ReachedLoads
from optimiser.solver.problem import BoundSide, LimitName
from service.progress import Tell, silent
from service.requests.runs import SimulationRequest
from service.simulation.confirmation import Confirmation, ConfirmedStep, Figure
from service.simulation.run import machine_of
from service.simulation.run_collector import require_sense
from service.simulation.setup import PreparedRun, prepared_program
from simulator.machine.acts import ProgramAct, WorkingstepTo
from simulator.machine.interpreter import interpret
from simulator.machine.samples import Episode
from simulator.machine.totals import Total, added
from simulator.machine.virtual import StockMap
from simulator.physics.spindle import idle_power
from simulator.removal.difference import StockDifference, bar_difference, height_difference
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import BarRadii, TurningStock
from simulator.removal.stations import stretch_lengths
from simulator.spec import Machine, MaterialMatch
from stepnc_model.programs.program import Program
from stepnc_model.units import NMM_S_PER_WATT, UM_PER_MM, nm_from_nmm


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
    plan: Plan, program: Program, advised: Program, *, tell: Tell = silent
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
    beside = _GivenRun(program, machine, material)
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


CM3 = 1e-3
"""cm³ in a mm³."""


def confirm(
    plan: Plan, program: Program, advised: Program, *, tell: Tell = silent
) -> Confirmation:
    """Run a program on the virtual machine and compare the result with its plan.

    Parameters
    ----------
    program : Program
        Program as given, whose remaining stock the advised program must leave.
    advised : Program
        Program that contains the advice of the plan.
    tell : callable
        Receives progress messages.

    Raises
    ------
    StepNcError
        When the machine cannot run the program.
    """
    totals = confirmed_totals(plan, program, advised, tell=tell)
    steps = []
    for advice in plan.advices:
        state = advice.after or advice.before
        total = totals[advice.workingstep.index]
        if state is None or total.id != advice.workingstep.id:
            continue
        figures = tuple(_figures(advice, state, total, plan.machine))
        steps.append(
            ConfirmedStep(
                id=total.id,
                figures=figures,
                left=total.left,
                is_advised=advice.status is AdviceStatus.ADVISED,
            )
        )
    return Confirmation(steps=tuple(steps), quantile=plan.safety)


def _figures(
    advice: Advice, state: EvaluatedSetting, totals: ConfirmedTotals, machine: Machine
) -> Iterator[Figure]:
    """Yield the predicted and simulated figures of one workingstep."""
    efficiency, cut, total = machine.spindle.efficiency, advice.cut, totals.nominal
    worse = totals.quantile if advice.safety_factor != 1.0 else None
    reached = ReachedLoads() if cut is None else cut.reached
    sloped = _on_ramp(cut)
    down = 1.0 if cut is None else cut.plunge_reached
    drive = max(
        reached.power * state.pass_power,
        sloped.power * state.ramp_power,
        down * state.plunge_power,
    )
    yield Figure(
        key="time_s",
        heading="time s",
        promised=state.time,
        simulated=total.duration - total.way_time,
    )
    yield Figure(
        key="cutting_force_n",
        heading="force N",
        promised=max(reached.force * state.cutting_force, sloped.force * state.ramp_force),
        simulated=total.force.value,
        at_quantile=None if worse is None else worse.force.value,
        bound=inf if state.thrust else _bound(state, LimitName.CUTTING_FORCE),
    )
    is_drill = cut is not None and cut.kind is CutKind.DRILLING
    yield Figure(
        key="thrust_n",
        heading="thrust N",
        promised=state.thrust * (reached.force if is_drill else down),
        simulated=total.thrust.value,
        at_quantile=None if worse is None else worse.thrust.value,
        bound=_bound(state, LimitName.CUTTING_FORCE),
    )
    bent = [reached.wall * each for each in _values(state.loads, LimitName.TOOL_DEFLECTION)]
    slopes = _values(state.plunge_loads, LimitName.TOOL_DEFLECTION)
    bent += [sloped.wall * each for each in slopes]
    yield Figure(
        key="deflection_um",
        heading="bent µm",
        promised=UM_PER_MM * max(bent, default=0.0),
        simulated=UM_PER_MM * total.deflection.value if bent else 0.0,
        at_quantile=None if worse is None or not bent else UM_PER_MM * worse.deflection.value,
        bound=UM_PER_MM * _bound(state, LimitName.TOOL_DEFLECTION),
    )
    yield Figure(
        key="torque_nm",
        heading="torque N·m",
        promised=nm_from_nmm(_torque(cut, state, reached, efficiency * drive)),
        simulated=nm_from_nmm(total.torque.value),
        at_quantile=None if worse is None else nm_from_nmm(worse.torque.value),
        bound=nm_from_nmm(_bound(state, LimitName.SPINDLE_TORQUE)),
    )
    yield Figure(
        key="cutting_power_w",
        heading="cut W",
        promised=efficiency * drive,
        simulated=total.cutting_power.value,
        at_quantile=None if worse is None else worse.cutting_power.value,
        bound=efficiency * _bound(state, LimitName.MOTOR_POWER),
    )
    yield Figure(
        key="drive_power_w",
        heading="drive W",
        promised=_drive_power(cut, state, drive, machine) if total.drive_power.value else drive,
        simulated=total.drive_power.value,
        at_quantile=None if worse is None else worse.drive_power.value,
    )
    yield Figure(
        key="volume_cm3",
        heading="volume cm³",
        promised=CM3 * (cut.volume or 0.0) if cut is not None else 0.0,
        simulated=CM3 * totals.volume,
    )


def _on_ramp(cut: Cut | None) -> ReachedLoads:
    """Share of the loads on a ramp that the axes reach."""
    way_in = None if cut is None else cut.way_in
    return ReachedLoads() if way_in is None or way_in.ramp is None else way_in.ramp.reached


def _torque(
    cut: Cut | None, state: EvaluatedSetting, reached: ReachedLoads, cutting_power: float
) -> float:
    """Greatest torque at the spindle, N·mm."""
    if cut is None or state.setting.speed <= 0.0:
        return 0.0
    if cut.torque_diameter is not None:
        return 0.5 * state.cutting_force * cut.torque_diameter
    if cut.kind is CutKind.DRILLING:
        # Where only the spindle slows, the power falls and the torque does not.
        return 0.5 * reached.force * state.cutting_force * cut.force_diameter
    return NMM_S_PER_WATT * cutting_power / (2.0 * pi * state.setting.speed)


def _drive_power(
    cut: Cut | None, state: EvaluatedSetting, drive: float, machine: Machine
) -> float:
    """Greatest power of the drive with what the idling spindle takes, W."""
    if cut is None or cut.is_air:
        return 0.0
    return max(
        place.power * drive
        + float(idle_power(machine.spindle, place.speed * state.setting.speed))
        for place in cut.power_places or (PowerPlace(),)
    )


def _values(loads: Iterable[LimitLoad], name: LimitName) -> list[float]:
    """Return the loads of all limits with the given name, in canonical units."""
    return [load.value for load in loads if load.limit.name is name]


def _bound(state: EvaluatedSetting, name: LimitName) -> float:
    """Return the smallest upper bound among limits with the given name, in canonical units."""
    return min(
        (
            load.bound
            for load in state.loads
            if load.limit.name is name and load.limit.sense is BoundSide.AT_MOST
        ),
        default=inf,
    )
