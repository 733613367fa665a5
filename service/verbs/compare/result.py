"""Result of ``compare``: plans side by side, and their differences in words."""

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from math import isclose
from typing import TYPE_CHECKING

from service.rendering.columns import Column
from service.rendering.view import Fact, ResultView, Table, TextLine
from service.verbs.compare.plan import NamedPlan, PlannedStep, PlanTotal, StepSetting
from service.verbs.result import Result
from stepnc_model.plurals import counted

if TYPE_CHECKING:
    import plotly.graph_objects as go

ALIKE = 1e-6
"""Relative difference of settings that count as the same."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StepOfPlan:
    """Workingstep in one plan."""

    name: str
    step: PlannedStep

    @property
    def setting(self) -> StepSetting | None:
        """Setting with which it would run."""
        return self.step.setting

    @property
    def feed(self) -> float | None:
        """Feed, mm/min; None where nothing is known."""
        return None if self.setting is None else self.setting.feed_mm_min

    @property
    def speed(self) -> float | None:
        """Spindle speed, rpm."""
        return None if self.setting is None else self.setting.spindle_rpm

    @property
    def depth(self) -> str | None:
        """Depth of a pass, mm, and number of passes."""
        at = self.setting
        return None if at is None else f"{at.axial_depth_mm:.4g} x {at.passes}"

    @property
    def limit(self) -> str:
        """Active limit, or why there is no advice."""
        return _words(self.step)


STEPS: tuple[Column[StepOfPlan], ...] = (
    Column(
        key="workingstep", heading="workingstep", is_key=True, is_words=True, is_of_row=True,
        value=lambda row: row.step.id,
    ),
    Column(key="plan", heading="plan", is_words=True, value=lambda row: row.name),
    Column(
        key="feed_mm_min", heading="feed mm/min", form=".1f", help="v_f",
        value=lambda row: row.feed,
    ),
    Column(
        key="spindle_rpm", heading="rpm", form=".1f", help="n",
        value=lambda row: row.speed,
    ),
    Column(
        key="depth_x_passes", heading="depth mm x passes", help="a_p",
        value=lambda row: row.depth,
    ),
    Column(key="active_limit", heading="active limit", is_words=True,
           value=lambda row: row.limit),
    Column(
        key="roughness_ra_um", heading="ideal Ra µm", form=".3g", is_optional=True,
        value=lambda row: row.step.roughness_ra_um,
    ),
    Column(key="time_s", heading="time s", form=".1f", value=lambda row: row.step.time),
    Column(
        key="energy_j", heading="energy kJ", form=".1f", scale=1e-3,
        value=lambda row: row.step.energy_j,
    ),
)  # fmt: skip

TOTALS: tuple[Column[PlanTotal], ...] = (
    Column(key="plan", heading="plan", is_words=True, value=lambda row: row.named.name),
    Column(key="mode", heading="mode", is_words=True, value=lambda row: row.named.plan.mode),
    Column(
        key="machine", heading="machine", is_words=True,
        value=lambda row: row.named.plan.machine,
    ),
    Column(
        key="material", heading="material", is_words=True,
        value=lambda row: row.named.plan.material,
    ),
    Column(key="time_s", heading="time s", form=".1f", value=lambda row: row.time),
    Column(
        key="energy_j", heading="energy kJ", form=".1f", scale=1e-3,
        value=lambda row: row.energy,
    ),
    Column(
        key="unchecked", heading="unchecked limits", form=".0f", is_optional=True,
        help="required limits that could not be looked at",
        value=lambda row: row.unchecked or None,
    ),
    Column(
        key="left_out", heading="not timed", form=".0f", is_optional=True,
        help="workingsteps that not every plan times",
        value=lambda row: row.left_out or None,
    ),
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ComparisonResult(Result):
    """Plans of one program; the others are told apart from the first."""

    plans: tuple[NamedPlan, ...]

    @property
    def rows(self) -> list[StepOfPlan]:
        """Every workingstep in every plan."""
        return [
            StepOfPlan(name=each.name, step=step)
            for steps in zip(*(each.plan.workingsteps for each in self.plans), strict=True)
            for each, step in zip(self.plans, steps, strict=True)
        ]

    @property
    def totals(self) -> list[PlanTotal]:
        """Totals of every plan, over the same workingsteps."""
        count = len(self.plans[0].plan.workingsteps)
        timed = [
            at
            for at in range(count)
            if all(each.plan.workingsteps[at].time is not None for each in self.plans)
        ]
        found = []
        for each in self.plans:
            steps = [each.plan.workingsteps[at] for at in timed]
            found.append(
                PlanTotal(
                    named=each,
                    time=sum(step.time or 0.0 for step in steps),
                    energy=sum(step.energy_j or 0.0 for step in steps),
                    left_out=count - len(timed),
                    unchecked=sum(len(step.unchecked) for step in each.plan.workingsteps),
                )
            )
        return found

    @property
    def differences(self) -> list[str]:
        """Sentences on what differs from the first plan, and on what does not."""
        first, *others = self.plans
        return [line for other in others for line in _differences(first, other)]

    def view(self) -> ResultView:
        """Return the totals, the workingsteps, and the differences."""
        program = self.plans[0].plan.program
        return ResultView([
            TextLine(text=f"{program}: {counted(len(self.plans), 'plan')}"),
            Table(columns=TOTALS, rows=self.totals, key="plans"),
            Table(
                columns=STEPS, rows=self.rows, key="workingsteps",
                row_of=lambda row: row.step.instance,
            ),
            *(TextLine(text=text, is_wrapped=True) for text in self.differences),
            Fact(key="differences", value=self.differences),
        ])  # fmt: skip

    def figures(self) -> "tuple[go.Figure, ...]":
        """Return time against energy of the plans, and the time of each workingstep."""
        from service.verbs.compare.figures import compared_figures  # noqa: PLC0415 (plotly)

        return compared_figures(self.totals)

    def page(self) -> str:
        """Return a self-contained page with both plots."""
        from service.rendering.pages import plot, rendered  # noqa: PLC0415 (Jinja)

        totals, steps = self.figures()
        return rendered(
            "comparison.html.jinja",
            program=self.plans[0].plan.program,
            names=", ".join(each.name for each in self.plans),
            totals=self.totals,
            total_columns=TOTALS,
            rows=self.rows,
            columns=STEPS,
            differences=self.differences,
            trade=plot(totals, "trade"),
            times=plot(steps, "times"),
        )


def _differences(first: NamedPlan, other: NamedPlan) -> Iterator[str]:
    """Sentences on one plan beside the first."""
    same: dict[str, list[str]] = defaultdict(list)
    for one, two in zip(first.plan.workingsteps, other.plan.workingsteps, strict=True):
        if _is_same(one, two):
            same[_why_same(first, other, one, two)].append(two.id)
        else:
            yield f"{two.id}: {_difference(first, other, one, two)}"
    for why, ids in same.items():
        listed = ", ".join(ids[:4]) + (f" and {len(ids) - 4} more" if len(ids) > 4 else "")
        yield f"{other.name} is the same as {first.name} in {listed}{why}"


def _is_same(one: PlannedStep, two: PlannedStep) -> bool:
    """True if a workingstep runs alike in two plans."""
    a, b = one.setting, two.setting
    if a is None or b is None:
        return a is b and one.status == two.status
    return a.passes == b.passes and all(
        isclose(x, y, rel_tol=ALIKE)
        for x, y in (
            (a.feed_mm_min, b.feed_mm_min),
            (a.spindle_rpm, b.spindle_rpm),
            (a.axial_depth_mm, b.axial_depth_mm),
        )
    )


def _why_same(first: NamedPlan, other: NamedPlan, one: PlannedStep, two: PlannedStep) -> str:
    """Reason why a workingstep runs alike, as far as the plans tell it."""
    if one.advised is None and two.advised is None:
        return f": {two.status}"
    if (first.plan.mode == "QC") != (other.plan.mode == "QC"):
        quality = two if other.plan.mode == "QC" else one
        if quality.required_roughness is None:
            return ": no roughness is required"
        if quality.active_limit != "roughness":
            return ": the required roughness does not bind"
    if one.active_limit == two.active_limit and two.active_limit is not None:
        return f": {_words(two)} limits both"
    return ""


def _difference(first: NamedPlan, other: NamedPlan, one: PlannedStep, two: PlannedStep) -> str:
    """Differences of a workingstep between two plans."""
    a, b = one.setting, two.setting
    if one.time is None or two.time is None or a is None or b is None:
        return f"{first.name} {one.status}, {other.name} {two.status} ({two.reason})"
    change = two.time - one.time
    parts = [
        f"{other.name} takes {two.time:.1f} s, "
        f"{abs(change):.1f} s {'more' if change > 0.0 else 'less'} than {first.name}"
    ]
    if a.passes != b.passes:
        parts.append(f"passes: {b.passes}, not {a.passes}")
    if not isclose(a.spindle_rpm, b.spindle_rpm, rel_tol=ALIKE):
        parts.append(f"rpm: {b.spindle_rpm:.0f}, not {a.spindle_rpm:.0f}")
    if one.active_limit != two.active_limit:
        parts.append(f"limited by {_words(two)}, not {_words(one)}")
    required = two.required_roughness
    rough = one.roughness_ra_um
    if required is not None and rough is not None and rough > required * (1.0 + ALIKE):
        parts.append(
            f"ideal Ra {rough:.3g} µm of {first.name} is above the required {required:.3g} µm"
        )
    return "; ".join(parts)


def _words(step: PlannedStep) -> str:
    """Active limit of a workingstep in words, or its status."""
    return (step.active_limit or step.status).replace("_", " ")
