"""From a cut and its conditions to a problem, and from a setting to what it does."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from math import inf, isfinite, pi
from types import MappingProxyType

from optimiser import workingstep as exact
from optimiser.advice import Load, State
from optimiser.cut import Cut, CutKind
from optimiser.limit import Limit, LimitName, Monomial, Sense
from optimiser.limits import (
    Conditions,
    drill_point,
    force_factor,
    force_load,
    limits_of,
    power_load,
    roughness_load,
    segment_at,
    speed_range,
    spindle_limits,
)
from optimiser.loads import scaled, thrust
from optimiser.modes import Free, Mode
from optimiser.problem import Cost, Problem, Setting
from optimiser.source import Source, along_paths
from optimiser.stability import stability_limits
from simulator.library import find_window
from simulator.physics.spindle import curve_segments
from simulator.physics.tool_life import tool_life

LEAST_DEPTH = 0.05
"""mm, no pass is planned shallower"""

LEAST_SPEED_RATIO = 0.1
"""of the greatest speed, when neither machine nor tool names a least one"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """What is asked of the optimiser."""

    mode: Mode = Mode.TC
    free: frozenset[Free] = frozenset({Free.FEED, Free.DEPTH})
    roughness: float | None = None
    """Ra in mm for all finished surfaces, instead of what the file says"""
    tool_change: float = 0.0
    """s to change a worn tool; 0: tool life does not count"""
    force_factors: Mapping[str, float] = field(default_factory=dict, hash=False)
    """accepted corrections of k_c by the id of the tool; a tool that is not named has none"""
    front: bool = False
    """whether the front between time, roughness and energy is wanted"""
    source: Source = along_paths
    """what makes the source of the cuts"""

    def __post_init__(self) -> None:
        for tool, factor in self.force_factors.items():
            if not (isfinite(factor) and factor > 0.0):
                raise ValueError(f"tool '{tool}': a factor on k_c of {factor:g}")
        # A copy: what the caller does with his own later must not change the task.
        object.__setattr__(self, "force_factors", MappingProxyType(dict(self.force_factors)))

    def force_factor(self, tool: str) -> float:
        """Accepted correction of k_c for a tool, by its id."""
        return self.force_factors.get(tool, 1.0)


def problem_of(cut: Cut, at: Conditions, task: Task) -> Problem:
    """The mathematical problem of a cut."""
    limits = limits_of(cut, at) + stability_limits(cut, at)
    given = cut.programmed
    if Free.FEED not in task.free:
        limits += tuple(_held_feed(given.feed, sense) for sense in Sense)
    passes = (given.passes, given.passes)
    if Free.DEPTH in task.free and cut.is_depth_free:
        passes = (1, max(given.passes, int(cut.total_depth / LEAST_DEPTH)))
    speeds, stretches = _stretches(cut, at, task)
    return Problem(
        limits=limits,
        cost=_cost(cut, at, task),
        total_depth=cut.total_depth,
        passes=passes,
        speeds=speeds,
        programmed=given,
        stretches=stretches,
    )


def _held_feed(feed: float, sense: Sense) -> Limit:
    """The programmed feed as a limit, when it is not free."""
    return Limit(
        name=LimitName.PROGRAMMED_FEED,
        load=Monomial(coefficient=1.0, feed_exponent=1.0),
        bound=feed,
        unit="mm",
        sense=sense,
        step=0.01,
    )


def _stretches(
    cut: Cut, at: Conditions, task: Task
) -> tuple[tuple[float, ...], tuple[tuple[Limit, ...], ...]]:
    """Speeds that may be chosen, and the spindle's limits on each stretch of its curve."""
    speed = cut.programmed.speed
    low, high = speed_range(cut, at)
    if Free.SPEED not in task.free or not low < high < inf:
        return (speed,), (spindle_limits(cut, at, segment_at(at, speed)),)
    low = max(low, LEAST_SPEED_RATIO * high)
    segments = [
        part
        for part in curve_segments(at.machine.spindle)
        if part.max_speed > low and part.min_speed < high
    ]
    inner = [part.max_speed for part in segments[:-1]]
    return (low, *inner, high), tuple(spindle_limits(cut, at, part) for part in segments)


def _cost(cut: Cut, at: Conditions, task: Task) -> Cost:
    """Time and energy of the cut on this machine."""
    machine = at.machine
    spindle = machine.spindle
    wear = _wear_rate(cut, at) if task.tool_change > 0.0 else None
    return Cost(
        length=cut.length,
        once_length=cut.floor.length if cut.floor is not None else 0.0,
        teeth=cut.tool.teeth,
        motor_power=scaled(power_load(cut, at), cut.load_share),
        link_time=cut.rest_time + (cut.link_length / machine.rapid if machine.rapid else 0.0),
        standby_power=machine.base_power + machine.coolant_power + spindle.idle_power,
        standby_power_per_speed=spindle.idle_power_per_speed,
        tool_change=task.tool_change if wear is not None else 0.0,
        wear_rate=wear,
    )


def _wear_rate(cut: Cut, at: Conditions) -> Monomial | None:
    """Tool lives used in one second: ``1/T = (v_c/C)^(1/n)``; None when no life is known."""
    window = find_window(at.material, cut.tool_kind, at.cutting_material)
    if window is None or window.taylor is None:
        return None
    exponent = 1.0 / window.taylor.exponent
    life = tool_life(window.taylor, pi * cut.diameter)
    return Monomial(coefficient=1.0 / life, speed_exponent=exponent)


def state_of(cut: Cut, problem: Problem, at: Conditions, setting: Setting) -> State:
    """Everything about a cut at one setting."""
    point = (setting.feed, setting.depth, setting.speed)
    floor = cut.floor
    roughness = [
        load.value(*point)
        for each in (cut, floor)
        if each is not None and (load := roughness_load(each)) is not None
    ]
    return State(
        setting=setting,
        feed=setting.feed * cut.tool.teeth * setting.speed,
        time=problem.cost.time(setting),
        energy=problem.cost.energy(setting),
        motor_power=_greater(power_load, cut, at, setting),
        cutting_force=_greater(force_load, replace(cut, plunge=None), at, setting),
        thrust=_thrust(cut, at, setting),
        roughness=max(roughness, default=None),
        loads=tuple(
            Load(
                limit=limit,
                value=limit.load.value(*point),
                bound=limit.bound_at(setting.speed),
            )
            for limit in exact.limits_at(problem, setting.speed)
        ),
    )


def _thrust(cut: Cut, at: Conditions, setting: Setting) -> float:
    """Force along the axis, N: of a drill, or of a mill's plunge."""
    sinking = cut if cut.kind is CutKind.DRILLING else cut.plunge
    if sinking is None:
        return 0.0
    load = thrust(sinking, at.material.kienzle, force_factor(at), drill_point(at))
    return load.value(setting.feed, setting.depth, setting.speed)


def _greater(
    load: Callable[[Cut, Conditions], Monomial], cut: Cut, at: Conditions, setting: Setting
) -> float:
    """A load of the walls, of the floor that is swept with them, or of a plunge: the greatest.

    No load of a plunge depends on the depth.
    """
    depths = [(cut, setting.depth)]
    if cut.floor is not None:
        depths.append((cut.floor, cut.floor.total_depth))
    if cut.plunge is not None:
        depths.append((cut.plunge, setting.depth))
    return max(
        load(each, at).value(setting.feed, depth, setting.speed) for each, depth in depths
    )
