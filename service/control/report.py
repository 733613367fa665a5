"""One self-contained HTML page for a run under control: same run, same bytes."""

from collections.abc import Iterator, Sequence
from html import escape

from controller.record import OVER
from service.buckets import Trace
from service.control.facts import (
    Row,
    disturbed_words,
    event_counts,
    exceeded,
    law_words,
    mode_words,
    rows,
    saved,
    whole,
)
from service.control.figures import GRAVE, PLAIN, chosen_events, control_figure
from service.control.run import ControlRun
from service.page import bullets, clock, headline, page, plot, table
from stepnc_model.units import mm_min_from_speed

MOST_EVENTS = 300
"""in the list, grave ones first; the file of the run has all"""


def control_page(run: ControlRun, trace: Trace) -> str:
    """The page as HTML.

    Parameters
    ----------
    run : ControlRun
    trace : Trace
        Of the same run.

    Returns
    -------
    str
    """
    found = rows(run)
    machine = run.machine
    body = f"""<h1>{escape(run.plan.program)}</h1>
<p class="sub">under control on {escape(machine.title)} ({escape(machine.name)}) ·
 law {escape(law_words(run))} · mode {mode_words(run)} ·
 {escape(run.material.reason)}</p>
{_first(run)}
<h2>Limits exceeded</h2>{bullets(("bad", text) for text in exceeded(run, found))}
<h2>The run</h2>
{plot(control_figure(run, found, trace), "run")}
<p class="sub">{escape(_resolution(trace))}</p>
<h2>Workingsteps</h2>{_numbers(found, whole(run))}
<p class="sub">time: programmed → under control; over s: above {OVER:g} times the set point;
 N·s: impulse above the set point</p>
<h2>What held the override</h2>{_reasons(found)}
<p class="sub">{escape(saved(run))} at the programmed feed</p>
<h2>Events</h2>{_events(run)}
<h2>Disturbances</h2><p>{escape(disturbed_words(run))}; seed {run.seed}</p>
<h2>Findings</h2>{bullets(_findings(run))}"""
    return page(f"{run.plan.program} under control on {machine.name}", body)


def _first(run: ControlRun) -> str:
    """The numbers that are looked at first."""
    total = whole(run).record
    share = run.time / run.progress - 1.0 if run.progress else 0.0
    return headline((
        ("as programmed", clock(run.progress)),
        ("under control", clock(run.time)),
        ("change", f"{share:+.1%}".replace("-", "−")),
        ("mean override", f"{100.0 * total.override:.0f} %"),
        ("greatest force", f"{total.peak:.0f} N"),
        ("above set point", f"{total.over_time:.2f} s"),
        ("holds of the feed", f"{whole(run).holds}"),
    ))


def _resolution(trace: Trace) -> str:
    """What one point of the plots stands for."""
    return (
        f"One point of the plots stands for {trace.width:.2g} s or less: lines show its least "
        "and greatest revolution, set point, expected force and factor its mean. Drag to look "
        "closer, double-click to come back."
    )


def _numbers(found: Sequence[Row], total: Row) -> str:
    heads = (
        "workingstep", "time s", "cutting", "feed mm/min", "override %", "force N", "hardest N",
        "bound there N", "over s", "N·s", "holds", "factor on k_c",
    )  # fmt: skip
    body = [(row.name, *_cells(row)) for row in found]
    return table(heads, body, (("total", *_cells(total)),))


def _cells(row: Row) -> tuple[str, ...]:
    record = row.record
    time = f"{row.planned:.1f} → {record.time:.1f}"
    if not record.revolutions:
        return (time, "0.0", *["–"] * 9)
    least, greatest = row.override_range
    factor = "–" if row.factor is None else f"{row.factor[0]:.3f} ± {row.factor[1]:.3f}"
    return (
        time,
        f"{record.cutting_time:.1f}",
        f"{mm_min_from_speed(record.feed):.1f}",
        f"{100.0 * record.override:.0f} ({100.0 * least:.0f}–{100.0 * greatest:.0f})",
        f"{record.force:.0f}",
        f"{record.peak:.0f}",
        "–" if row.set_point is None else f"{row.set_point:.1f}",
        f"{record.over_time:.2f}",
        f"{record.excess:.2f}",
        f"{row.holds}",
        factor,
    )


def _reasons(found: Sequence[Row]) -> str:
    return bullets(("", f"{row.name}: {_set_point(row)}{row.why}") for row in found if row.id)


def _set_point(row: Row) -> str:
    """What it follows from."""
    return f"set point by {row.bound}; " if row.set_point is not None else ""


def _events(run: ControlRun) -> str:
    """How many of each, and the list."""
    shown = chosen_events(run, MOST_EVENTS)
    left_out = len(run.events) - len(shown)
    more = f" {left_out} more are left out of this list." if left_out else ""
    items = (
        (
            "error" if event.kind in GRAVE else "" if event.kind in PLAIN else "warning",
            f"{event.time:.2f} s  {event.kind.value}: {event.text}",
        )
        for event in shown
    )
    return f'<p class="sub">{escape(event_counts(run))}.{more}</p>{bullets(items)}'


def _findings(run: ControlRun) -> Iterator[tuple[str, str]]:
    """All findings, equal ones once."""
    unique = {str(finding): finding.severity.value for finding in run.findings}
    for text, severity in unique.items():
        yield severity, text
