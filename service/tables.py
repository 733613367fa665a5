"""Tables on a terminal."""

import os
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from optimiser.advice import Advice, Plan, State, Status
from optimiser.limit import LimitName
from optimiser.stability import Basis
from service.contents import Contents
from service.terminal import clean
from simulator.spec import (
    Machine,
    Material,
)
from simulator.work_holding import (
    Clamp,
    Holding,
)
from stepnc_model.errors import Finding, Severity
from stepnc_model.units import (
    kn_from_newtons,
    kw_from_watts,
    m_min_from_speed,
    mm_min_from_speed,
    n_um_from_n_mm,
    rpm_from_rev_s,
)

if TYPE_CHECKING:
    from service.confirmation import Confirmation, Figure

Row = Sequence[str]

COLOURS = {Severity.ERROR: "31", Severity.WARNING: "33", Severity.NOTE: "36"}
"""ANSI colours of findings"""

PLUNGE = 4
"""column of the plunge feed, left out where no workingstep has one of its own"""

MOST_FINDINGS = 40
"""findings shown in a table; --json has all"""


MOST_INDENTED = 20
"""levels of executables that a table shows by indenting"""


def print_plan(plan: Plan, confirmation: "Confirmation | None" = None) -> None:
    """Advice for a program: a row for each workingstep, then totals and findings."""
    material = plan.material.material
    print_line(
        f"{plan.program}: mode {plan.mode.value}, machine {plan.machine.name} "
        f"({plan.machine.title}), material {material.title}"
    )
    header: Row = (
        "workingstep", "operation", "tool", "feed mm/min", "plunge mm/min", "rpm",
        "depth mm x passes", "active limit", "time s",
    )  # fmt: skip
    rows: list[Row] = [_advice_row(advice) for advice in plan.advices]
    total = f"{plan.time_before:.1f} -> {plan.time_after:.1f}"
    rows.append(("total", "", "", "", "", "", "", "", total))
    if not any(row[PLUNGE] for row in rows):
        header, *rows = (_without(row, PLUNGE) for row in (header, *rows))
    print_table(header, rows)
    print_line(_safety(plan))
    saving = sum(advice.saving_of_free_speed for advice in plan.advices)
    if saving > 0.0:
        print_line(f"a free spindle speed would save {saving:.1f} s (--free feed,depth,speed)")
    print_line(
        f"energy {plan.energy_before / 1e3:.1f} -> {plan.energy_after / 1e3:.1f} kJ; "
        f"totals leave out {plan.left_out}"
    )
    for advice in plan.advices:
        print_line(f"  {advice.workingstep.id}: {_reason(advice)}")
    for advice in plan.advices:
        if advice.front:
            _print_front(advice)
    if confirmation is not None:
        _print_confirmation(confirmation)
    print_findings(plan.findings)


def _without(row: Row, column: int) -> Row:
    """A row without one of its cells."""
    return (*row[:column], *row[column + 1 :])


def _safety(plan: Plan) -> str:
    """At which quantile of k_c bounds are kept, and what that costs."""
    factors = [advice.safety_factor for advice in plan.advices if advice.safety_factor != 1.0]
    if not factors:
        return "loads are nominal: nothing is added for the spread of k_c"
    low, high = f"{min(factors):.3g}", f"{max(factors):.3g}"
    cost = sum(advice.cost_of_safety for advice in plan.advices)
    return (
        f"bounds are kept at the {100.0 * plan.safety:g} % quantile of k_c (--safety), nominal "
        f"loads × {low if low == high else f'{low} to {high}'}, which costs {cost:.1f} s"
    )


def _print_confirmation(confirmation: "Confirmation") -> None:
    """What was promised beside what the run found, and their ratio."""
    print_line("promised -> found on the virtual machine (found / promised)")
    headings = [figure.heading for figure in confirmation.steps[0].figures]
    rows = [
        (step.id, *(_figure(figure) for figure in step.figures)) for step in confirmation.steps
    ]
    print_table(("workingstep", *headings), rows)
    for text in confirmation.passed:
        print_line(f"bound passed: {text}", COLOURS[Severity.ERROR])


def _figure(figure: "Figure") -> str:
    if figure.ratio is None:
        return "" if figure.found == 0.0 else f"0 -> {figure.found:.4g}"
    return f"{figure.promised:.4g} -> {figure.found:.4g} ({figure.ratio:.3f})"


def print_contents(contents: Contents) -> None:
    """What is in a file."""
    print_line(
        f"{contents.name}: {contents.instances} instances, "
        f"schemas {', '.join(contents.schemas) or 'none'}"
    )
    program = contents.program
    if program is not None:
        steps = {int(step.ref): step for step in program.workingsteps}
        rows = []
        for each in program.executables:
            step = steps.get(int(each.ref))
            tool = getattr(program.get(step.tool_ref), "its_id", "") if step else ""
            rows.append((
                str(each.ref),
                "  " * min(each.level, MOST_INDENTED) + each.keyword.lower(),
                each.id,
                step.operation_type if step else "",
                tool,
            ))
        print_table(("instance", "executable", "id", "operation", "tool"), rows)
    print_findings(contents.findings)
    print_line("usable" if contents.is_usable else "cannot be used: see the errors above")


def print_entries(kind: str, entries: Sequence[Machine | Material]) -> None:
    """A library as a table."""
    if kind == "machines":
        machines = [entry for entry in entries if isinstance(entry, Machine)]
        rows = [
            (each.name, each.kind.value, _power(each), _top_speed(each), each.title)
            for each in machines
        ]
        print_table(("name", "kind", "kW", "rpm", "title"), rows)
        return
    materials = [entry for entry in entries if isinstance(entry, Material)]
    rows = [
        (
            each.name,
            each.iso_group,
            f"{each.kienzle.k_c11:g}",
            f"{each.kienzle.m_c:g}",
            each.title,
        )
        for each in materials
    ]
    print_table(("name", "ISO", "k_c1.1 N/mm2", "m_c", "title"), rows)


def print_entry(entry: Machine | Material) -> None:
    """One machine or material."""
    print_line(f"{entry.name}: {entry.title}")
    facts = _machine_facts(entry) if isinstance(entry, Machine) else _material_facts(entry)
    print_table(("what", "value"), facts)
    print_line(f"source: {entry.source}")
    for remark in entry.remarks:
        print_line(f"remark: {remark}")


def _machine_facts(machine: Machine) -> list[Row]:
    """What a planner wants to know of a machine."""
    facts: list[Row] = [
        (
            f"spindle at {rpm_from_rev_s(point.speed):g} rpm",
            f"{kw_from_watts(point.power):g} kW"
            + (f", {point.torque / 1000.0:g} N·m" if point.torque else ""),
        )
        for point in machine.spindle.curve
    ]
    facts.append(("efficiency", f"{machine.spindle.efficiency:g}"))
    for name, value in (
        ("greatest speed rpm", machine.spindle.max_speed and machine.spindle.max_speed * 60.0),
        ("rapid mm/min", machine.rapid and mm_min_from_speed(machine.rapid)),
        ("greatest feed mm/min", machine.max_feed and mm_min_from_speed(machine.max_feed)),
        ("greatest cutting force N", machine.max_cutting_force),
        ("greatest depth mm", machine.max_axial_depth),
        ("base power kW", kw_from_watts(machine.base_power)),
    ):
        facts.append((name, "not limited" if value is None else f"{value:g}"))
    for mode in machine.modes:
        of = mode.tool or (f"{mode.tool_diameter:g} mm" if mode.tool_diameter else "")
        facts.append((
            f"mode of {mode.part.value} {of}".rstrip() + f" along {mode.direction.value}",
            f"{mode.natural_frequency:g} Hz, damping {mode.damping_ratio:g}, "
            f"{n_um_from_n_mm(mode.stiffness):g} N/µm",
        ))
    facts += [_held(holding) for holding in machine.holdings]
    return facts


def _held(holding: Holding) -> Row:
    """One work-holding of a machine."""
    of = f" of {holding.setup}" if holding.setup else ""
    if isinstance(holding, Clamp):
        force = f"{kn_from_newtons(holding.holding_force):g} kN"
        return f"clamps{of}", f"{force}, friction {holding.friction:g}"
    force = f"{kn_from_newtons(holding.clamping_force):g} kN at rest"
    return f"chuck{of}", f"{force}, {holding.jaws} jaws, friction {holding.friction:g}"


def _material_facts(material: Material) -> list[Row]:
    """What a planner wants to know of a material."""
    facts: list[Row] = [
        ("ISO group", material.iso_group or "none"),
        ("also called", ", ".join(material.equivalents)),
        ("k_c1.1 N/mm2", f"{material.kienzle.k_c11:g}"),
        ("m_c", f"{material.kienzle.m_c:g}"),
    ]
    for window in material.windows:
        body = f" {window.tool_body.value}" if window.tool_body else ""
        low = window.min_cutting_speed
        high = window.max_cutting_speed
        shown = " to ".join(f"{m_min_from_speed(each):g}" for each in (low, high) if each)
        facts.append((f"m/min with {window.cutting_material.value}{body}", shown))
    return facts


def _advice_row(advice: Advice) -> Row:
    """One workingstep, programmed -> advised."""
    before, after = advice.before, advice.after
    names = (advice.workingstep.id, advice.workingstep.operation_type, advice.tool.id)
    if before is None:
        return (*names, "", "", "", "", advice.status.value, "")
    given = before.setting
    if after is None or advice.status is not Status.ADVISED:
        return (
            *names,
            f"{mm_min_from_speed(before.feed):.1f}",
            _plunge_feed(before),
            f"{rpm_from_rev_s(given.speed):.1f}",
            f"{given.depth:.4g} x {given.passes}",
            advice.status.value,
            f"{before.time:.1f}",
        )
    best = after.setting
    depth = f"{given.depth:.4g} x {given.passes}"
    new_depth = f"{best.depth:.4g} x {best.passes}"
    old_speed, speed = f"{rpm_from_rev_s(given.speed):.1f}", f"{rpm_from_rev_s(best.speed):.1f}"
    return (
        *names,
        f"{mm_min_from_speed(before.feed):.1f} -> {mm_min_from_speed(after.feed):.1f}",
        _plunge_change(before, after),
        speed if speed == old_speed else f"{old_speed} -> {speed}",
        depth if depth == new_depth else f"{depth} -> {new_depth}",
        advice.active_words,
        f"{before.time:.1f} -> {after.time:.1f}",
    )


def _plunge_feed(state: State) -> str:
    """Plunge feed in mm/min; empty where there is none of its own."""
    return "" if state.plunge_feed is None else f"{mm_min_from_speed(state.plunge_feed):.1f}"


def _plunge_change(before: State, after: State) -> str:
    """Plunge feed as programmed -> advised; a path of other passes may begin otherwise."""
    return " -> ".join(feed for feed in (_plunge_feed(before), _plunge_feed(after)) if feed)


def _reason(advice: Advice) -> str:
    """Why this feed, and what would change it."""
    if advice.status is not Status.ADVISED or advice.after is None:
        return f"{advice.status.value}: {advice.reason}"
    text = advice.reason
    limit = next(load.limit for load in advice.after.loads if load.limit.name is advice.active)
    if advice.saving_of_one_more > 0.0:
        text += f"; {limit.step:g} {limit.unit} more saves {advice.saving_of_one_more:.2g} s"
    if (
        advice.after.roughness is not None
        and advice.cut is not None
        and advice.cut.is_finishing
    ):
        text += f"; leaves Ra {advice.after.roughness * 1e3:.3g} µm"
    deepest = advice.deepest_first_time
    if deepest is not None and deepest > advice.after.time * 1.001:
        text += f"; the deepest passes would have taken {deepest:.1f} s"
    if advice.plunge_reason:
        text += f"; plunge feed: {advice.plunge_reason}"
    return text + _stability(advice, advice.after)


def _stability(advice: Advice, state: State) -> str:
    """The depth that measured modes allow, or why they are not asked."""
    found = advice.stability
    if found is None or found.basis is Basis.ESTIMATED:
        return ""
    load = next((load for load in state.loads if load.limit.name is LimitName.STABILITY), None)
    if load is None:
        return f"; stability not bounded: {found.reason or 'damped at this speed'}"
    text = f"; stable to {load.bound:.3g} mm at this speed"
    if found.least is not None:
        text += f", {found.least:.3g} mm at any"
    return text + f" ({found.reason})"


def _print_front(advice: Advice) -> None:
    """The front between time, roughness and energy of one workingstep."""
    print_line(f"front of {advice.workingstep.id}:")
    rows = []
    for point in advice.front:
        state = point.state
        roughness = "" if state.roughness is None else f"{state.roughness * 1e3:.3g}"
        rows.append((
            f"{state.time:.2f}",
            roughness,
            f"{state.energy / 1e3:.2f}",
            f"{mm_min_from_speed(state.feed):.1f}",
            f"{rpm_from_rev_s(state.setting.speed):.0f}",
            f"{state.setting.passes}",
        ))
    print_table(("time s", "Ra µm", "energy kJ", "feed mm/min", "rpm", "passes"), rows)


def print_findings(findings: Sequence[Finding]) -> None:
    """Findings, errors first, equal ones once."""
    order = list(Severity)[::-1]
    ranked = sorted(findings, key=lambda finding: order.index(finding.severity))
    unique = list(dict.fromkeys(str(finding) for finding in ranked))
    severities = {str(finding): finding.severity for finding in ranked}
    for text in unique[:MOST_FINDINGS]:
        print_line(text, COLOURS[severities[text]])
    if len(unique) > MOST_FINDINGS:
        print_line(f"... and {len(unique) - MOST_FINDINGS} more findings (--json has all)")


def _power(machine: Machine) -> str:
    return f"{max(kw_from_watts(point.power) for point in machine.spindle.curve):g}"


def _top_speed(machine: Machine) -> str:
    top = machine.spindle.max_speed
    return "" if top is None else f"{rpm_from_rev_s(top):g}"


def print_table(header: Row, rows: Sequence[Row]) -> None:
    """Columns as wide as their widest cell; figures to the right."""
    columns = list(zip(header, *rows, strict=True))
    widths = [max(len(cell) for cell in column) for column in columns]
    for index, row in enumerate((header, *rows)):
        cells = [cell.ljust(width) for cell, width in zip(row, widths, strict=True)]
        print_line("  ".join(cells).rstrip())
        if index == 0:
            print_line("  ".join("-" * width for width in widths))


def print_line(text: str, colour: str = "") -> None:
    """One line of data, to stdout; in a colour on a terminal that wants colours."""
    text = clean(text)
    if colour and sys.stdout.isatty() and not os.environ.get("NO_COLOR"):
        text = f"\x1b[{colour}m{text}\x1b[0m"
    sys.stdout.write(text + "\n")
