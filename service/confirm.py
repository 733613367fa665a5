"""Comparison of a plan with its simulated run: the predictions of ``optimise`` against results.

Both sides define each figure alike: time on the path itself, without tool change and approach;
cutting force as the mean over a revolution, plunges excluded; thrust along the axis of drills
and plunges; cutting power at the edge; drive power while there are chips.
"""

from collections.abc import Iterable, Iterator
from math import inf

from optimiser.advice import Advice, EvaluatedSetting, LimitLoad, Plan
from optimiser.cut import CutKind, ReachedLoads
from optimiser.problem import BoundSide, LimitName
from service.confirmation import Confirmation, ConfirmedStep, Figure
from service.reading import Tell, silent
from service.simulation.run import run_of_program
from simulator.machine.totals import Total
from simulator.physics.spindle_motion import idle_power
from simulator.spec import Machine
from stepnc_model.program import Program


def confirm(plan: Plan, program: Program, *, tell: Tell = silent) -> Confirmation:
    """Run a program on the virtual machine and compare the result with its plan.

    Parameters
    ----------
    plan : Plan
        Its cuts should include what the axes reach (``along_paths(…, is_run=True)``); otherwise
        their figures assume the programmed feed everywhere.
    program : Program
        Program that contains the advice of the plan.
    tell : callable
        Receives progress messages.

    Raises
    ------
    StepNcError
        When the machine cannot run the program.
    """
    totals = run_of_program(program, plan.machine, plan.material, tell=tell)
    steps = []
    for advice in plan.advices:
        state = advice.after or advice.before
        name, total = totals[advice.workingstep.index]
        if state is None or name != advice.workingstep.id:
            continue
        figures = tuple(_figures(advice, state, total, plan.machine))
        steps.append(ConfirmedStep(id=name, figures=figures))
    return Confirmation(steps=tuple(steps))


def _figures(
    advice: Advice, state: EvaluatedSetting, total: Total, machine: Machine
) -> Iterator[Figure]:
    """Yield the predicted and simulated figures of one workingstep."""
    efficiency, speed = machine.spindle.efficiency, state.setting.speed
    if advice.cut is not None:
        speed *= advice.cut.power_speed
    reached = ReachedLoads() if advice.cut is None else advice.cut.reached
    way_in = None if advice.cut is None else advice.cut.way_in
    sloped = ReachedLoads() if way_in is None or way_in.ramp is None else way_in.ramp.reached
    is_drill = advice.cut is not None and advice.cut.kind is CutKind.DRILLING
    drive = max(reached.power * state.motor_power, state.plunge_power)
    cutting = drive * efficiency
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
        bound=inf if state.thrust else _bound(state, LimitName.CUTTING_FORCE),
    )
    yield Figure(
        key="thrust_n",
        heading="thrust N",
        promised=state.thrust * (reached.force if is_drill else 1.0),
        found=total.thrust.value,
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
        bound=1e3 * _bound(state, LimitName.TOOL_DEFLECTION),
    )
    yield Figure(
        key="cutting_power_w",
        heading="cut W",
        promised=cutting,
        found=total.cutting_power.value,
        bound=efficiency * _bound(state, LimitName.MOTOR_POWER),
    )
    idle = float(idle_power(machine.spindle, speed)) if total.drive_power.value else 0.0
    yield Figure(
        key="drive_power_w",
        heading="drive W",
        promised=drive + idle if advice.cut is not None and not advice.cut.is_air else 0.0,
        found=total.drive_power.value,
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
