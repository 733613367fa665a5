"""Plan of a STEP-NC program as text, JSON, tables and one self-contained HTML page.

JSON keys carry their units and never change, because other programs read them.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from math import isfinite
from typing import TYPE_CHECKING, Any

from optimiser.advice import Advice, AdviceStatus, EvaluatedSetting, Plan
from optimiser.bounds.roughness import IDEAL, basis_of
from optimiser.bounds.stability import Basis
from optimiser.modes import Mode
from optimiser.planning.reasons import slower_than_programmed
from optimiser.solver.problem import LimitName
from service.errors import BAD_INPUT, INFEASIBLE, LIMIT_EXCEEDED, NOTHING_ADVISED, OK
from service.rendering.columns import Cell, Change, Column, finding_record
from service.rendering.text import RED
from service.rendering.view import Fact, Findings, Item, ResultView, Table, TextLine
from service.verbs.optimise.plan_record import (
    FRONT,
    advice_record,
    chatter_words,
    plunge_feed_mm_min,
    unchecked_words,
)
from service.verbs.optimise.result import OptimiseResult
from simulator.library import find_window
from simulator.physics.tool_life import ASSUMED_LIFE
from stepnc_model.errors import Finding
from stepnc_model.plurals import counted
from stepnc_model.units import (
    kj_from_joules,
    kw_from_watts,
    mm_min_from_speed,
    rpm_from_rev_s,
    um_from_mm,
)

if TYPE_CHECKING:
    import plotly.graph_objects as go

    from service.simulation.confirmation import Confirmation, ConfirmedStep


def _change(value: Callable[[EvaluatedSetting], Cell]) -> Callable[[Advice], Cell]:
    """Return a column value that pairs the programmed and the advised value."""

    def pair(advice: Advice) -> Cell:
        before, after = advice.before, advice.after
        if before is None:
            return None
        return Change(before=value(before), after=value(after or before))

    return pair


def _depth(state: EvaluatedSetting) -> str:
    return f"{state.setting.depth:.4g} x {state.setting.passes}"


def _energy(state: EvaluatedSetting) -> float:
    return state.energy


def _active(advice: Advice) -> str:
    """Active limit of an advice, or its status if no feed was advised."""
    is_advised = advice.after is not None and advice.status is AdviceStatus.ADVISED
    return advice.active_words if is_advised else advice.status.value


NAME: Column[Advice] = Column(
    key="id", heading="workingstep", value=lambda advice: advice.workingstep.id, is_key=True
)
TIME: Column[Advice] = Column(
    key="time_s", heading="time s", form=".1f", value=_change(lambda state: state.time)
)
SHOWN: tuple[Column[Advice], ...] = (
    NAME,
    Column(
        key="operation", heading="operation", is_words=True,
        value=lambda advice: advice.workingstep.operation_type,
    ),
    Column(key="tool", heading="tool", value=lambda advice: advice.tool.id, is_words=True),
    Column(
        key="feed_mm_min", heading="feed mm/min", form=".1f", help="v_f",
        value=_change(lambda state: mm_min_from_speed(state.feed)),
    ),
    Column(
        key="plunge_feed_mm_min", heading="plunge mm/min", form=".1f",
        help="plunge feed into the material",
        value=_change(plunge_feed_mm_min), is_optional=True,
    ),
    Column(
        key="spindle_rpm", heading="rpm", form=".1f", help="n",
        value=_change(lambda state: rpm_from_rev_s(state.setting.speed)),
    ),
    Column(
        key="depth_x_passes", heading="depth mm x passes", help="a_p", value=_change(_depth)
    ),
)  # fmt: skip
ACTIVE: Column[Advice] = Column(
    key="active_limit", heading="active limit", value=_active, is_words=True
)
RISK: Column[Advice] = Column(
    key="chatter_risk", heading="chatter risk", value=chatter_words, is_words=True,
    is_optional=True,
    help="depth cut, and the optimistic end of the estimated stable depth, mm",
)  # fmt: skip

TEXT = (
    *SHOWN,
    ACTIVE,
    RISK,
    TIME,
)
"""Columns of the plan table on a terminal."""

PAGE = (
    *SHOWN,
    Column(
        key="motor_power_kw", heading="kW", form=".2f",
        help="power that the cut draws from the motor",
        value=_change(lambda state: kw_from_watts(state.motor_power)),
    ),
    ACTIVE,
    RISK,
    TIME,
)  # fmt: skip
"""Columns of the plan table in the HTML report."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramAdvice(OptimiseResult):
    """Plan of a STEP-NC program, the file written, and the comparison with a simulated run."""

    plan: Plan
    confirmation: "Confirmation | None" = None
    """Comparison with the simulated run; None if it was not requested."""
    told: tuple[Finding, ...] = ()
    """Warnings about the program that were told already."""

    @property
    def name(self) -> str:
        """Name of the program."""
        return self.plan.program

    @property
    def time_before(self) -> float:
        """Time of the program as given, s."""
        return self.plan.time_before

    @property
    def time_after(self) -> float:
        """Time of the advised program, s."""
        return self.plan.time_after

    @property
    def exit_code(self) -> int:
        """Exit code: bad data first, then conflicts of limits, and bounds that are exceeded."""
        if self.plan.has_bad_data:
            return BAD_INPUT
        if self.plan.is_infeasible:
            return INFEASIBLE
        is_passed = self.confirmation is not None and bool(self.confirmation.passed)
        if is_passed or self.plan.faults:
            return LIMIT_EXCEEDED
        return OK if self.is_advised else NOTHING_ADVISED

    def view(self) -> ResultView:
        """Return a row per workingstep, totals, reasons, and what was asked for beside them."""
        return ResultView([
            *_head(self.plan),
            *_totals(self.plan),
            *_fronts(self.plan),
            *(_confirmation_items(self.confirmation) if self.confirmation else ()),
            *self._along_items(),
            Findings(findings=self.plan.findings, reported=self.told, key=""),
        ])

    def _along_items(self) -> Iterator[Item]:
        if self.along is None:
            return
        from service.along_path.output import along_path_items, along_path_record  # noqa: PLC0415 (numpy)

        yield Fact(key="along_path", value=along_path_record(self.along))
        yield from along_path_items(self.along)

    def figures(self) -> "list[go.Figure]":
        """Return figures of time, feed, power and limits by workingstep."""
        from service.plots.plan_figures import plan_figures  # noqa: PLC0415 (plotly)

        return list(plan_figures(self.plan))

    def page(self) -> str:
        """Return the HTML report of the plan."""
        from service.rendering.pages import plot, rendered  # noqa: PLC0415 (Jinja)

        plan, along = self.plan, self.along
        along_figures: list[Any] = []
        along_columns: tuple[Any, ...] = ()
        if along is not None:
            from service.along_path.figures import along_path_figures  # noqa: PLC0415 (plotly)
            from service.along_path.output import STEP  # noqa: PLC0415 (numpy)

            along_figures, along_columns = along_path_figures(along), STEP
        before, after = plan.time_before, plan.time_after
        return rendered(
            "plan.html.jinja",
            plan=plan,
            mode=mode_words(plan),
            columns=PAGE,
            unchecked=unchecked_words(plan).removeprefix("; "),
            change=f"{after / before - 1.0:+.0%}" if before else "",
            reasons=[
                (advice.status.value, f"{advice.workingstep.id}: {_reason(advice)}")
                for advice in plan.advices
            ],
            plots=[plot(each, f"plot{row}") for row, each in enumerate(self.figures())],
            along=along,
            along_columns=along_columns,
            along_plots=[plot(each, f"along{row}") for row, each in enumerate(along_figures)],
        )


def _head(plan: Plan) -> Iterator[Item]:
    """Yield the summary, and the advice by workingstep."""
    material, slower = plan.material.material, slower_than_programmed(plan)
    for text in slower:
        yield TextLine(text=text, colour=RED)
    yield TextLine(
        text=f"{plan.program}: mode {mode_words(plan)}, machine {plan.machine.name} "
        f"({plan.machine.title}), material {material.title}{unchecked_words(plan)}"
    )
    yield Fact(key="program", value=plan.program)
    yield Fact(key="mode", value=plan.mode.value)
    yield Fact(key="machine", value=plan.machine.name)
    yield Fact(key="material", value=material.name)
    yield Fact(
        key="safety",
        value={
            "quantile": plan.safety,
            "cost_s": sum(advice.cost_of_safety for advice in plan.advices),
        },
    )
    saving = sum(advice.saving_of_free_speed for advice in plan.advices)
    yield Fact(key="free_speed_saves_s", value=saving)
    total = f"{plan.time_before:.1f} -> {plan.time_after:.1f}"
    yield Table(
        key="workingsteps", columns=TEXT, rows=plan.advices, record=advice_record,
        foot={"workingstep": "total", "time s": total},
    )  # fmt: skip
    yield Fact(key="is_checked", value=not plan.unchecked)
    yield Fact(
        key="unlikely_surfaces",
        value=[advice.workingstep.id for advice in plan.unlikely_surfaces],
    )
    yield Fact(key="total_time_s", value={"before": plan.time_before, "after": plan.time_after})
    yield Fact(key="slower_than_programmed", value=list(slower))
    yield Fact(
        key="refused",
        value=[
            {
                "id": each.id,
                "instance": str(each.ref),
                "reason": each.reason,
                "is_infeasible": each.is_infeasible,
            }
            for each in plan.refused
        ],
    )
    yield Fact(key="findings", value=[finding_record(each) for each in plan.findings])


def _totals(plan: Plan) -> Iterator[Item]:
    """Yield what margins and speeds cost, the energy, and the reasons."""
    yield TextLine(text=_safety(plan))
    saving = sum(advice.saving_of_free_speed for advice in plan.advices)
    if saving > 0.0:
        yield TextLine(
            text=f"a free spindle speed would save {saving:.1f} s (--free feed,depth,speed)"
        )
    before, after = map(kj_from_joules, (plan.energy_before, plan.energy_after))
    yield TextLine(
        text=f"energy {before:.1f} -> {after:.1f} kJ; totals leave out {plan.left_out}"
    )
    for text in cost_words(plan):
        yield TextLine(text=text)
    for advice in plan.advices:
        yield TextLine(text=f"  {advice.workingstep.id}: {_reason(advice)}")


def cost_words(plan: Plan) -> Iterator[str]:
    """Yield the cost of a plan, what it leaves out, and the tool lives used by tool."""
    rates = plan.machine.costs
    shown = [(each.tool.id, each.after or each.before) for each in plan.advices]
    priced = [(tool, state) for tool, state in shown if state and state.money is not None]
    if rates is None or not priced:
        return
    total = sum(state.money or 0.0 for _, state in priced)
    missing = len({tool for tool, state in priced if state.lives is None})
    unworn = f", wear of {counted(missing, 'tool')} of unknown life" if missing else ""
    plain = set(_tools_of_assumed_life(plan))
    yield (
        f"cost {total:.4g} {rates.currency} of machine time and worn edges ({rates.source}); "
        f"left out: set-up, programming, material, tool changes between workingsteps{unworn}"
    )
    used: dict[str, float] = {}
    for tool, state in priced:
        if state.lives is not None:
            used[tool] = used.get(tool, 0.0) + state.lives
    if used:
        lives = ", ".join(
            f"{tool} {share:.2g}{' (assumed)' if tool in plain else ''}"
            for tool, share in used.items()
        )
        yield f"edge lives used, by a catalogue within a factor of about 6: {lives}"
    if plain:
        yield (
            f"no tool life is known of {', '.join(sorted(plain))}: {ASSUMED_LIFE:g} min in the "
            "middle of the catalogue's speeds is assumed; calibrate --table learns it"
        )


def _tools_of_assumed_life(plan: Plan) -> Iterator[str]:
    """Yield the tools whose life no file states."""
    for advice in plan.advices:
        at, cut = advice.conditions, advice.cut
        if at is None or cut is None:
            continue
        window = find_window(at.material, cut.tool_kind, at.cutting_material)
        if window is not None and window.taylor is None:
            yield advice.tool.id


def _fronts(plan: Plan) -> Iterator[Item]:
    """Yield the fronts of time, roughness and energy."""
    for advice in plan.advices:
        if advice.front:
            yield TextLine(text=f"front of {advice.workingstep.id} (Ra is {IDEAL}):")
            yield Table(columns=FRONT, rows=advice.front)


def _confirmation_items(confirmation: "Confirmation") -> Iterator[Item]:
    """Yield predicted and simulated values, with their ratios."""
    yield Fact(key="confirmation", value=_confirmation(confirmation))
    yield TextLine(text="predicted -> found on the virtual machine (found / predicted)")
    columns: list[Column[ConfirmedStep]] = [
        Column(key="id", heading="workingstep", value=lambda step: step.id),
        *(
            Column(heading=figure.heading, value=partial(_figure_at, place))
            for place, figure in enumerate(confirmation.steps[0].figures)
        ),
    ]
    yield Table(columns=columns, rows=confirmation.steps)
    yield TextLine(text=_nearest(confirmation))
    for text in confirmation.passed:
        yield TextLine(text=f"not as planned: {text}", colour=RED)


def mode_words(plan: Plan) -> str:
    """Name of a mode; of QC with what its roughness is."""
    if plan.mode is not Mode.QC:
        return plan.mode.value
    if plan.machine.only_stated_limits:
        return f"{plan.mode.value} (Ra is {IDEAL})"
    return f"{plan.mode.value} (Ra of {100.0 * plan.roughness_quantile:g} % of surfaces)"


def _safety(plan: Plan) -> str:
    """State the k_c quantile at which bounds are kept, and the time that costs."""
    factors = [advice.safety_factor for advice in plan.advices if advice.safety_factor != 1.0]
    if not factors:
        return "loads are nominal: no margin is added for the spread of k_c"
    low, high = f"{min(factors):.3g}", f"{max(factors):.3g}"
    cost = sum(advice.cost_of_safety for advice in plan.advices)
    return (
        f"bounds are kept at the {100.0 * plan.safety:g} % quantile of k_c (--safety), nominal "
        f"loads × {low if low == high else f'{low} to {high}'}, which costs {cost:.1f} s"
    )


def _nearest(confirmation: "Confirmation") -> str:
    """State the bound that the run comes nearest to, and whether the same stock is left."""
    nearest = confirmation.nearest
    text = "no bound to compare with"
    if nearest is not None:
        step, figure = nearest
        text = (
            f"at the {100.0 * confirmation.quantile:g} % quantile of k_c nearest to a bound: "
            f"{step}, {figure.heading} {figure.greatest:.4g} of {figure.bound:.4g}"
        )
    unknown = confirmation.unknown_stock
    if unknown:
        return f"{text}; the stock left is not compared: {', '.join(unknown)}"
    if any(step.left is not None and step.left.is_seen for step in confirmation.steps):
        return text
    return f"{text}; every workingstep leaves the stock that the program as given leaves"


def _figure_at(place: int, step: "ConfirmedStep") -> str:
    figure = step.figures[place]
    if figure.ratio is None:
        return "" if figure.simulated == 0.0 else f"0 -> {figure.simulated:.4g}"
    return f"{figure.promised:.4g} -> {figure.simulated:.4g} ({figure.ratio:.3f})"


def _reason(advice: Advice) -> str:
    """Explain the advised feed, and which change would allow a higher one."""
    if advice.status is not AdviceStatus.ADVISED or advice.after is None:
        is_told = advice.reason.startswith(advice.status.value)
        return advice.reason if is_told else f"{advice.status.value}: {advice.reason}"
    text = advice.reason
    limit = next(load.limit for load in advice.after.loads if load.limit.name is advice.active)
    if advice.saving_of_one_more > 0.0:
        text += f"; {limit.step:g} {limit.unit} more saves {advice.saving_of_one_more:.2g} s"
    if (
        advice.after.roughness is not None
        and advice.cut is not None
        and advice.cut.is_finishing
    ):
        text += f"; leaves Ra {um_from_mm(advice.after.roughness):.3g} µm ({IDEAL})"
        text += _expected(advice)
    if advice.cut is not None:
        text += "".join(f"; {each.words}" for each in advice.cut.refused_passes[:1])
    deepest = advice.deepest_first_time
    if deepest is not None and deepest > advice.after.time * 1.001:
        text += f"; the deepest passes would have taken {deepest:.1f} s"
    if advice.plunge_reason:
        text += f"; plunge feed: {advice.plunge_reason}"
    if advice.unchecked:
        text += "; unchecked: " + "; ".join(limit.words for limit in advice.unchecked)
    return text + _stability_words(advice, advice.after)


def _expected(advice: Advice) -> str:
    """Median and probability of a finished surface; empty where nothing is known of it."""
    state, at = advice.after, advice.conditions
    if state is None or state.surface is None or at is None:
        return ""
    text = f", {um_from_mm(state.surface.median):.3g} µm expected ({basis_of(at)})"
    chance = advice.roughness_probability
    if chance is None or at.roughness is None:
        return text
    return f"{text}, keeps Ra {um_from_mm(at.roughness):g} µm with {100.0 * chance:.0f} %"


def _stability_words(advice: Advice, state: EvaluatedSetting) -> str:
    """Describe the stable depth by the measured modes, or why it is not bounded."""
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


def _confirmation(confirmation: "Confirmation") -> dict[str, Any]:
    """Return predicted and found values as a JSON object."""
    return {
        "workingsteps": [
            {
                "id": step.id,
                **{
                    figure.key: {
                        "promised": figure.promised,
                        "found": figure.simulated,
                        "ratio": figure.ratio,
                        "bound": figure.bound if isfinite(figure.bound) else None,
                        "found_at_quantile": figure.at_quantile,
                    }
                    for figure in step.figures
                },
                "stock_left": step.left
                and {"volume_mm3": step.left.volume, "deviation_mm": step.left.deviation},
            }
            for step in confirmation.steps
        ],
        "quantile": confirmation.quantile,
        "passed": list(confirmation.passed),
    }
