"""Comparison of a plan with its simulated run: the predictions of ``optimise`` against results.

Both sides define each figure alike: time on the path itself, without tool change and approach;
cutting force as the mean over a revolution, plunges excluded; thrust along the axis of drills
and plunges; cutting power at the edge; drive power while there are chips.

Figures are compared with the nominal k_c, bounds with that at the quantile of the plan.
"""

from collections.abc import Iterable, Iterator
from math import inf, pi

from optimiser.advice import Advice, AdviceStatus, EvaluatedSetting, LimitLoad, Plan
from optimiser.cut import Cut, CutKind, PowerPlace, ReachedLoads
from optimiser.problem import BoundSide, LimitName
from service.confirmation import Confirmation, ConfirmedStep, Figure
from service.confirmed_run import ConfirmedTotals, confirmed_totals
from service.reading import Tell, silent
from simulator.physics.spindle_motion import idle_power
from simulator.spec import Machine
from stepnc_model.program import Program
from stepnc_model.units import nm_from_nmm

CM3 = 1e-3
"""cm³ in a mm³."""


def confirm(
    plan: Plan, given: Program, advised: Program, *, tell: Tell = silent
) -> Confirmation:
    """Run a program on the virtual machine and compare the result with its plan.

    Parameters
    ----------
    plan : Plan
    given : Program
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
    totals = confirmed_totals(plan, given, advised, tell=tell)
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
        found=total.duration - total.way_time,
    )
    yield Figure(
        key="cutting_force_n",
        heading="force N",
        promised=max(reached.force * state.cutting_force, sloped.force * state.ramp_force),
        found=total.force.value,
        at_quantile=None if worse is None else worse.force.value,
        bound=inf if state.thrust else _bound(state, LimitName.CUTTING_FORCE),
    )
    is_drill = cut is not None and cut.kind is CutKind.DRILLING
    yield Figure(
        key="thrust_n",
        heading="thrust N",
        promised=state.thrust * (reached.force if is_drill else down),
        found=total.thrust.value,
        at_quantile=None if worse is None else worse.thrust.value,
        bound=_bound(state, LimitName.CUTTING_FORCE),
    )
    bent = [reached.wall * each for each in _values(state.loads, LimitName.TOOL_DEFLECTION)]
    slopes = _values(state.plunge_loads, LimitName.TOOL_DEFLECTION)
    bent += [sloped.wall * each for each in slopes]
    yield Figure(
        key="deflection_um",
        heading="bent µm",
        promised=1e3 * max(bent, default=0.0),
        found=1e3 * total.deflection.value if bent else 0.0,
        at_quantile=None if worse is None or not bent else 1e3 * worse.deflection.value,
        bound=1e3 * _bound(state, LimitName.TOOL_DEFLECTION),
    )
    yield Figure(
        key="torque_nm",
        heading="torque N·m",
        promised=nm_from_nmm(_torque(cut, state, reached, efficiency * drive)),
        found=nm_from_nmm(total.torque.value),
        at_quantile=None if worse is None else nm_from_nmm(worse.torque.value),
        bound=nm_from_nmm(_bound(state, LimitName.SPINDLE_TORQUE)),
    )
    yield Figure(
        key="cutting_power_w",
        heading="cut W",
        promised=efficiency * drive,
        found=total.cutting_power.value,
        at_quantile=None if worse is None else worse.cutting_power.value,
        bound=efficiency * _bound(state, LimitName.MOTOR_POWER),
    )
    yield Figure(
        key="drive_power_w",
        heading="drive W",
        promised=_drive_power(cut, state, drive, machine) if total.drive_power.value else drive,
        found=total.drive_power.value,
        at_quantile=None if worse is None else worse.drive_power.value,
    )
    yield Figure(
        key="volume_cm3",
        heading="volume cm³",
        promised=CM3 * (cut.volume or 0.0) if cut is not None else 0.0,
        found=CM3 * totals.volume,
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
    return 1e3 * cutting_power / (2.0 * pi * state.setting.speed)


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
