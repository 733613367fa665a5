"""A controlled run as text, JSON and one self-contained HTML page; equal runs give equal bytes.

JSON keys carry their units and never change, because other programs read them.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from controller.record import EXCESS_RATIO, RunRecord
from service.control.cuts import COLUMNS as CUT_COLUMNS
from service.control.cuts import cuts, loads_words
from service.control.facts import (
    ControlRow,
    disturbed,
    disturbed_words,
    event_counts,
    exceeded,
    law_words,
    mode_words,
    rows,
    saved,
    whole,
)
from service.control.run import ControlRun
from service.errors import BAD_INPUT, LIMIT_EXCEEDED, OK
from service.rendering.columns import Cell, Change, Column, record
from service.rendering.text import RED
from service.rendering.view import Fact, Findings, Item, ResultView, Table, TextLine
from service.verbs.result import Result
from stepnc_model.errors import StepNcError
from stepnc_model.units import mm_min_from_speed

if TYPE_CHECKING:
    import plotly.graph_objects as go

MOST_EVENTS = 300
"""Most events listed on the page, serious ones first; the JSON output lists all."""


def _cut(value: Callable[[RunRecord], Cell]) -> Callable[[ControlRow], Cell]:
    """Return a column value that is shown only for rows in which chips were cut."""
    return lambda row: value(row.record) if row.record.revolutions else None


def _override(row: ControlRow) -> str | None:
    """Mean override with its range, in per cent."""
    if not row.record.revolutions:
        return None
    least, greatest = row.override_range
    return f"{100.0 * row.record.override:.0f} ({100.0 * least:.0f}–{100.0 * greatest:.0f})"


def _bound(row: ControlRow) -> str | None:
    """Set point at the most critical revolution, in N, and the limit that it follows from."""
    return None if row.set_point is None else f"{row.set_point:.1f} {row.bound}".rstrip()


def _factor(row: ControlRow) -> str | None:
    return None if row.factor is None else f"{row.factor[0]:.3f} ± {row.factor[1]:.3f}"


def _wear(row: ControlRow) -> str | None:
    return None if row.wear is None else f"{row.wear[0]:.2f} ± {row.wear[1]:.2f}"


SHOWN: tuple[Column[ControlRow], ...] = (
    Column(heading="workingstep", value=lambda row: row.name, is_key=True),
    Column(
        heading="time s", form=".1f", help="programmed, then under control",
        value=lambda row: Change(before=row.planned, after=row.record.time),
    ),
    Column(heading="cutting s", form=".1f", value=lambda row: row.record.cutting_time),
    Column(
        heading="feed mm/min", form=".1f", help="mean while cutting, v_f",
        value=_cut(lambda record: mm_min_from_speed(record.feed)),
    ),
    Column(heading="override %", help="mean, minimum and maximum, u", value=_override),
    Column(
        heading="force N", help="mean, and at the revolution closest to its bound",
        value=_cut(lambda record: f"{record.force:.0f}, hardest {record.peak:.0f}"),
    ),
    Column(heading="bound there N", help="F_ref, and the limit it follows from", value=_bound),
    Column(
        heading="over s", form=".2f", help=f"above {EXCESS_RATIO:g} times the bound",
        value=_cut(lambda record: record.over_time),
    ),
    Column(
        heading="excess N·s", form=".2f", help="impulse above the bound",
        value=_cut(lambda record: record.excess),
    ),
    Column(
        heading="holds", help="number of feed holds",
        value=lambda row: row.holds if row.record.revolutions else None,
    ),
    Column(
        heading="k_c factor", help="measured over catalogue value, without wear", value=_factor,
    ),
    Column(heading="wear mm", help="estimated from the forces, VB", value=_wear),
)  # fmt: skip
"""Columns of the table on a terminal and on the page."""

NUMBERS: tuple[Column[ControlRow], ...] = (
    Column(key="time_s.programmed", value=lambda row: row.planned),
    Column(key="time_s.actual", value=lambda row: row.record.time),
    Column(key="cutting_time_s", value=lambda row: row.record.cutting_time),
    Column(key="revolutions.with_chips", value=lambda row: row.record.revolutions),
    Column(key="revolutions.without_force", value=lambda row: row.record.lost),
    Column(key="mean_feed_mm_min", value=lambda row: mm_min_from_speed(row.record.feed)),
    Column(key="override.mean", value=lambda row: row.record.override),
    Column(key="override.least", value=lambda row: row.override_range[0]),
    Column(key="override.greatest", value=lambda row: row.override_range[1]),
    Column(key="force_n.mean", value=lambda row: row.record.force),
    Column(key="force_n.nearest_to_bound", value=lambda row: row.record.peak),
    Column(key="over_set_point_s", value=lambda row: row.record.over_time),
    Column(key="longest_over_set_point_s", value=lambda row: row.record.longest_over.seconds),
    Column(
        key="longest_over_set_point_percent",
        value=lambda row: 100.0 * row.record.longest_over.most or None,
    ),
    Column(key="override_not_followed_s", value=lambda row: row.record.astray),
    Column(key="spindle_power_w.mean", value=lambda row: row.record.mean_power),
    Column(key="spindle_power_w.greatest", value=lambda row: row.record.power),
    Column(key="excess_impulse_n_s", value=lambda row: row.record.excess),
    Column(key="holds", value=lambda row: row.holds),
)
"""JSON columns of a workingstep and of the whole run."""


JSON: tuple[Column[ControlRow], ...] = (
    Column(key="id", value=lambda row: row.id),
    Column(key="begin_s", value=lambda row: row.begin),
    *NUMBERS,
    Column(key="bound_there_n", value=lambda row: row.set_point),
    Column(key="set_point_by", value=lambda row: row.bound or None),
)
"""JSON columns of a workingstep."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlResult(Result):
    """A run under control."""

    run: ControlRun

    @property
    def exit_code(self) -> int:
        """Exit code: 3 where workingsteps were left out, 5 where the loop had to intervene."""
        if self.run.faults:
            return BAD_INPUT
        return LIMIT_EXCEEDED if exceeded(self.run, rows(self.run)) else OK

    def view(self) -> ResultView:
        """Return a row per workingstep, totals, reasons, events, disturbances, findings."""
        run, found = self.run, rows(self.run)
        return ResultView([
            *_summary(run),
            Table(
                key="workingsteps", columns=JSON, rows=found, record=_step_record,
                is_shown=False,
            ),
            Table(columns=SHOWN, rows=(*found, whole(run))),
            *(TextLine(text=text) for text in _sentences(run, found)),
            Fact(
                key="total",
                value={"program_time_s": run.time_planned, **record(NUMBERS, whole(run))},
            ),
            Fact(
                key="disturbances",
                value=[
                    {"word": word, "has_come": has_come} for word, has_come in disturbed(run)
                ],
            ),
            Fact(
                key="events",
                value=[
                    {"time_s": event.time, "kind": event.kind.value, "text": event.text}
                    for event in run.events
                ],
            ),
            Table(key="cuts", columns=CUT_COLUMNS, rows=cuts(run), is_shown=False),
            Fact(key="limits_exceeded", value=list(exceeded(run, found))),
            *(
                TextLine(text=f"limit exceeded: {text}", colour=RED)
                for text in exceeded(run, found)
            ),
            Fact(key="left_out", value=list(run.faults)),
            Findings(findings=run.findings),
        ])  # fmt: skip

    def figures(self) -> "list[go.Figure]":
        """Return override, feed and force over time, if the run kept its signals."""
        from service.control.figures import control_figure  # noqa: PLC0415 (plotly)

        trace = self.run.trace
        return [] if trace is None else [control_figure(self.run, rows(self.run), trace)]

    def page(self) -> str:
        """Return the HTML report.

        Raises
        ------
        StepNcError
            When the run kept no signals: it was run without a report.
        """
        from service.control.figures import GRAVE, PLAIN, chosen_events  # noqa: PLC0415 (plotly)
        from service.rendering.pages import plot, rendered  # noqa: PLC0415 (Jinja)

        run, trace = self.run, self.run.trace
        if trace is None:
            raise StepNcError("the run kept no signals: name a report when it is run")
        found, events = rows(run), chosen_events(run, MOST_EVENTS)
        kinds = dict.fromkeys(GRAVE, "error") | dict.fromkeys(PLAIN, "")
        return rendered(
            "control.html.jinja",
            run=run,
            law=law_words(run),
            mode=mode_words(run),
            rows=found,
            whole=whole(run),
            change=f"{run.time / run.progress - 1.0 if run.progress else 0.0:+.1%}",
            columns=SHOWN,
            exceeded=exceeded(run, found),
            figure=plot(self.plot(), "run"),
            width=trace.width,
            saved=saved(run),
            events=[
                (
                    kinds.get(event.kind, "warning"),
                    f"{event.time:.2f} s  {event.kind.value}: {event.text}",
                )
                for event in events
            ],
            left_out=len(run.events) - len(events),
            counts=event_counts(run),
            loads=loads_words(run),
            disturbed=disturbed_words(run),
        )


def _summary(run: ControlRun) -> Iterator[Item]:
    """Yield the run, its law and its machine."""
    machine, material = run.machine, run.material.material
    yield TextLine(
        text=f"{run.plan.program}: law {law_words(run)}, mode {mode_words(run)}, "
        f"machine {machine.name} ({machine.title}), material {material.title}"
    )
    look_ahead = run.settings.look_ahead if run.has_preview else None
    band = run.settings.band
    for key, value in (
        ("program", run.plan.program),
        ("machine", machine.name),
        ("material", material.name),
        ("law", run.law.value),
        ("look_ahead_revolutions", look_ahead),
        ("mode", run.criterion.value),
        ("override_band", [band.floor, band.ceiling]),
        ("seed", run.seed),
        ("is_stopped", run.is_stopped),
        ("samples", run.samples),
    ):
        yield Fact(key=key, value=value)


def _sentences(run: ControlRun, rows: Sequence[ControlRow]) -> Iterator[str]:
    """Yield what held the override, what was saved, and what happened."""
    for row in rows:
        if row.id is not None:
            yield f"  {row.name}: {row.why}"
    yield f"{saved(run)} at the programmed feed"
    yield (
        "hardest: the revolution closest to its bound; over: time above "
        f"{EXCESS_RATIO:g} times the bound; excess: impulse above the bound, including noise"
    )
    yield f"events: {event_counts(run)}"
    if words := loads_words(run):
        yield f"load in per cent of the reference load: {words}"
    yield f"disturbed: {disturbed_words(run)}; seed {run.seed}"


def _step_record(row: ControlRow) -> dict[str, Any]:
    """Return a workingstep as a JSON object."""
    return {
        **record(JSON, row),
        "held_by": dict(row.shares),
        "inhibition": row.inhibition or None,
        "kc_factor": _factor_json(row),
        "flank_wear": _wear_json(row),
    }


def _factor_json(row: ControlRow) -> dict[str, Any] | None:
    """Return measured over catalogue k_c as a JSON object; None with too few readings."""
    if row.factor is None:
        return None
    value, deviation = row.factor
    readings = row.record.ratio.readings
    return {"value": value, "deviation": deviation, "readings": readings}


def _wear_json(row: ControlRow) -> dict[str, Any] | None:
    """Return the estimated wear of the tool as a JSON object; None if it is not known."""
    life = row.record.life
    if life is None:
        return None
    return {
        "value_mm": life.flank_wear,
        "deviation_mm": life.uncertainty,
        "basis": life.basis,
        "is_worn_out": life.is_worn_out,
    }
