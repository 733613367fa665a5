"""Columns of ``machines``, and what matters of one machine."""

from service.rendering.columns import Column
from service.verbs.library import EntryFact
from simulator.spec import Handling, Machine
from simulator.work_holding import Clamp, Holding
from stepnc_model.units import (
    kn_from_newtons,
    kw_from_watts,
    mm_min_from_speed,
    ms_from_seconds,
    n_um_from_n_mm,
    nm_from_nmm,
    rpm_from_rev_s,
)

MACHINES: tuple[Column[Machine], ...] = (
    Column(
        key="name", kind=str, heading="name", is_key=True,
        value=lambda machine: machine.name,
    ),
    Column(key="kind", kind=str, heading="kind", value=lambda machine: machine.kind.value),
    Column(
        key="power_kw", heading="kW", form="g", help="maximum power of the spindle motor",
        value=lambda machine: max(kw_from_watts(each.power) for each in machine.spindle.curve),
    ),
    Column(
        key="max_speed_rpm", heading="rpm", form="g", help="maximum spindle speed",
        value=lambda machine: None
        if machine.spindle.max_speed is None
        else rpm_from_rev_s(machine.spindle.max_speed),
    ),
    Column(key="title", kind=str, heading="title", value=lambda machine: machine.title),
)  # fmt: skip

CONTROL = (
    "fir, unless --control names another; not identified on a machine: its filter times follow "
    "from the axes' acceleration and jerk (docs/models.md); compare yours with stepnc blockfit"
)
"""Which control model a machine of the library has, and where it comes from."""


def machine_facts(machine: Machine) -> list[EntryFact]:
    """List the data of a machine that matter to a planner, as name and value."""
    facts: list[EntryFact] = [
        (
            f"spindle at {rpm_from_rev_s(point.speed):g} rpm",
            f"{kw_from_watts(point.power):g} kW"
            + (f", {nm_from_nmm(point.torque):g} N·m" if point.torque else ""),
        )
        for point in machine.spindle.curve
    ]
    facts.append(("efficiency", f"{machine.spindle.efficiency:g}"))
    fastest = machine.spindle.max_speed
    for name, value in (
        ("maximum speed rpm", fastest and rpm_from_rev_s(fastest)),
        ("rapid mm/min", machine.rapid and mm_min_from_speed(machine.rapid)),
        ("maximum feed mm/min", machine.max_feed and mm_min_from_speed(machine.max_feed)),
        ("maximum cutting force N", machine.max_cutting_force),
        ("maximum depth mm", machine.max_axial_depth),
        ("base power kW", kw_from_watts(machine.base_power)),
    ):
        facts.append((name, "not limited" if value is None else f"{value:g}"))
    if machine.block_time is not None:
        of = f" ({machine.block_time_source})" if machine.block_time_source else ""
        facts.append(("block time ms", f"{ms_from_seconds(machine.block_time):g}{of}"))
    for name, value in (
        ("least block mm", machine.least_block),
        ("least feed change", machine.least_feed_change),
    ):
        if value is not None:
            facts.append((name, f"{value:g}"))
    facts.append(("motion control", CONTROL))
    for mode in machine.modes:
        of = mode.tool or (f"{mode.tool_diameter:g} mm" if mode.tool_diameter else "")
        facts.append((
            f"mode of {mode.part.value} {of}".rstrip() + f" along {mode.direction.value}",
            f"{mode.natural_frequency:g} Hz, damping {mode.damping_ratio:g}, "
            f"{n_um_from_n_mm(mode.stiffness):g} N/µm",
        ))
    facts += [_held(holding) for holding in machine.holdings]
    if machine.handling is not None:
        facts += _handled(machine.handling)
    if machine.deviation is not None:
        feed, traverse = machine.deviation.feed, machine.deviation.traverse
        shown = f"±{100.0 * feed:g} % in feed, ±{100.0 * traverse:g} % in rapid, uniform"
        facts.append(("power deviation", f"{shown} ({machine.deviation.source})"))
    return facts


def _handled(handling: Handling) -> list[EntryFact]:
    """Describe the states between parts and batches, as name and value."""
    states = {
        "batch setup": handling.batch_setup,
        "part setup": handling.part_setup,
        "part ejection": handling.part_ejection,
        "batch ejection": handling.batch_ejection,
    }
    facts = [
        (name, f"{state.time:g} s, {kw_from_watts(state.power):g} kW")
        for name, state in states.items()
    ]
    scatter = f"±{100.0 * handling.time_scatter:g} % of these times, uniform"
    return [*facts, ("handling scatter", f"{scatter} ({handling.source})")]


def _held(holding: Holding) -> EntryFact:
    """Describe one work-holding of a machine, as name and value."""
    of = f" of {holding.setup}" if holding.setup else ""
    if isinstance(holding, Clamp):
        force = f"{kn_from_newtons(holding.holding_force):g} kN"
        return f"clamps{of}", f"{force}, friction {holding.friction:g}"
    force = f"{kn_from_newtons(holding.clamping_force):g} kN at rest"
    return f"chuck{of}", f"{force}, {holding.jaws} jaws, friction {holding.friction:g}"
