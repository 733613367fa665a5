"""A run under control as a table on a terminal."""

from controller.record import OVER
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
from service.control.run import ControlRun
from service.tables import print_findings, print_line, print_table
from stepnc_model.units import mm_min_from_speed

RED = "31"
"""ANSI colour of what failed"""


def print_control(run: ControlRun) -> None:
    """A row for each workingstep, totals, reasons, events, disturbances, findings."""
    machine, material = run.machine, run.material.material
    print_line(
        f"{run.plan.program}: law {law_words(run)}, mode {mode_words(run)}, "
        f"machine {machine.name} ({machine.title}), material {material.title}"
    )
    header = (
        "workingstep", "time s", "cutting s", "feed mm/min", "override %", "force N",
        "bound there N", "over s", "excess N·s", "holds", "k_c factor",
    )  # fmt: skip
    found = rows(run)
    body = [(row.name, *_numbers(row)) for row in found]
    print_table(header, [*body, ("total", *_numbers(whole(run)))])
    for row in found:
        if row.id is not None:
            print_line(f"  {row.name}: {row.why}")
    print_line(f"{saved(run)} at the programmed feed")
    print_line(
        "hardest: the revolution that came nearest to what bounds it there; over: above "
        f"{OVER:g} times its bound; excess: all above it, noise too"
    )
    print_line(f"events: {event_counts(run)}")
    print_line(f"disturbed: {disturbed_words(run)}; seed {run.seed}")
    for text in exceeded(run, found):
        print_line(f"limit exceeded: {text}", RED)
    print_findings(run.findings)


def _numbers(row: Row) -> tuple[str, ...]:
    """Of one workingstep or of all; bare where nothing was cut."""
    record = row.record
    time = f"{row.planned:.1f} -> {record.time:.1f}"
    if not record.revolutions:
        return (time, "0.0", *[""] * 8)
    least, greatest = row.override_range
    limit = f" {row.bound}" if row.bound else ""
    return (
        time,
        f"{record.cutting_time:.1f}",
        f"{mm_min_from_speed(record.feed):.1f}",
        f"{100.0 * record.override:.0f} ({100.0 * least:.0f}–{100.0 * greatest:.0f})",
        f"{record.force:.0f}, hardest {record.peak:.0f}",
        "" if row.set_point is None else f"{row.set_point:.1f}{limit}",
        f"{record.over_time:.2f}",
        f"{record.excess:.2f}",
        f"{row.holds}",
        "" if row.factor is None else f"{row.factor[0]:.3f} ± {row.factor[1]:.3f}",
    )
