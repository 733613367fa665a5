"""A controlled run as text, JSON and one self-contained HTML page; equal runs give equal bytes.

JSON keys carry their units and never change, because other programs read them.
"""

from collections.abc import Callable
from typing import Any

from controller.record import EXCESS_RATIO, RunRecord
from service.buckets import BucketedRun
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
from service.rendering.columns import Cell, Change, Column
from service.rendering.records import dump, finding_record, record, records
from service.rendering.text import RED, print_findings, print_line, print_table
from stepnc_model.units import mm_min_from_speed

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


def print_control(run: ControlRun) -> None:
    """Print a row per workingstep, then totals, reasons, events, disturbances, findings."""
    machine, material, found = run.machine, run.material.material, rows(run)
    print_line(
        f"{run.plan.program}: law {law_words(run)}, mode {mode_words(run)}, "
        f"machine {machine.name} ({machine.title}), material {material.title}"
    )
    print_table(SHOWN, (*found, whole(run)))
    for row in found:
        if row.id is not None:
            print_line(f"  {row.name}: {row.why}")
    print_line(f"{saved(run)} at the programmed feed")
    print_line(
        "hardest: the revolution closest to its bound; over: time above "
        f"{EXCESS_RATIO:g} times the bound; excess: impulse above the bound, including noise"
    )
    print_line(f"events: {event_counts(run)}")
    if words := loads_words(run):
        print_line(f"load in per cent of the reference load: {words}")
    print_line(f"disturbed: {disturbed_words(run)}; seed {run.seed}")
    for text in exceeded(run, found):
        print_line(f"limit exceeded: {text}", RED)
    print_findings(run.findings)


def control_json(run: ControlRun) -> str:
    """Return the run as JSON: totals, workingsteps, events and findings."""
    found = rows(run)
    columns: tuple[Column[ControlRow], ...] = (
        Column(key="id", value=lambda row: row.id),
        Column(key="begin_s", value=lambda row: row.begin),
        *NUMBERS,
        Column(key="bound_there_n", value=lambda row: row.set_point),
        Column(key="set_point_by", value=lambda row: row.bound or None),
    )
    return dump({
        "program": run.plan.program,
        "machine": run.machine.name,
        "material": run.material.material.name,
        "law": run.law.value,
        "look_ahead_revolutions": run.settings.look_ahead if run.has_preview else None,
        "mode": run.criterion.value,
        "override_band": [run.settings.band.floor, run.settings.band.ceiling],
        "seed": run.seed,
        "is_stopped": run.is_stopped,
        "samples": run.samples,
        "workingsteps": [
            {
                **values,
                "held_by": dict(row.shares),
                "inhibition": row.inhibition or None,
                "kc_factor": _factor_json(row),
                "flank_wear": _wear_json(row),
            }
            for row, values in zip(found, records(columns, found), strict=True)
        ],
        "total": {"program_time_s": run.time_planned, **record(NUMBERS, whole(run))},
        "disturbances": [
            {"word": word, "has_come": has_come} for word, has_come in disturbed(run)
        ],
        "events": [
            {"time_s": event.time, "kind": event.kind.value, "text": event.text}
            for event in run.events
        ],
        "cuts": records(CUT_COLUMNS, cuts(run)),
        "limits_exceeded": list(exceeded(run, found)),
        "left_out": list(run.faults),
        "findings": [finding_record(finding) for finding in run.findings],
    })


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


def control_page(run: ControlRun, trace: BucketedRun) -> str:
    """Return the HTML report of a controlled run.

    Parameters
    ----------
    run : ControlRun
    trace : BucketedRun
        Signals of the same run.
    """
    from service.control.figures import (  # noqa: PLC0415 (plotly)
        GRAVE,
        PLAIN,
        chosen_events,
        control_figure,
    )
    from service.rendering.pages import plot, rendered  # noqa: PLC0415 (Jinja)

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
        figure=plot(control_figure(run, found, trace), "run"),
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
