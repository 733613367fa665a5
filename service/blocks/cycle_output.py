"""Result of ``cycletime`` as text, JSON and page."""

from service.blocks.cycle_time import CycleRow, CycleTimeResult, LosingStretch
from service.rendering.columns import Column
from service.rendering.pages import plot, rendered
from service.rendering.records import dump, finding_record, record, records
from service.rendering.text import print_findings, print_line, print_table
from stepnc_model.units import mm_min_from_speed


def _off(row: CycleRow) -> str:
    """Relative error of the prediction."""
    if not row.actual:
        return ""
    return f"{100.0 * (row.predicted / row.actual - 1.0):+.2f} %"


ROWS: tuple[Column[CycleRow], ...] = (
    Column(
        key="workingstep", heading="workingstep", is_key=True, is_words=True,
        value=lambda row: row.workingstep,
    ),
    Column(key="tool", heading="tool", form=".0f", value=lambda row: row.tool or None),
    Column(key="blocks", heading="blocks", form=".0f", value=lambda row: row.blocks),
    Column(
        key="theoretical_s", heading="theoretical s", form=".2f", help="length over feed",
        value=lambda row: row.programmed,
    ),
    Column(
        key="block_rate_s", heading="block rate s", form=".2f",
        help="at the feed that block rate and axes allow: the modified program",
        value=lambda row: row.by_rate,
    ),
    Column(
        key="predicted_s", heading="predicted s", form=".2f",
        help="with acceleration and corners by the model of the control",
        value=lambda row: row.predicted,
    ),
    Column(
        key="actual_s", heading="actual s", form=".2f", is_optional=True,
        value=lambda row: row.actual,
    ),
    Column(heading="predicted off", is_optional=True, value=_off),
)  # fmt: skip

STRETCHES: tuple[Column[LosingStretch], ...] = (
    Column(
        key="workingstep", heading="workingstep", is_optional=True, is_words=True,
        value=lambda row: row.workingstep,
    ),
    Column(
        key="first_block", heading="from", form=".0f", help="number of the block or line",
        value=lambda row: row.first,
    ),
    Column(key="last_block", heading="to", form=".0f", value=lambda row: row.last),
    Column(key="blocks", heading="blocks", form=".0f", value=lambda row: row.blocks),
    Column(
        key="spacing_mm", heading="spacing mm", form=".4g", help="mean length of a block",
        value=lambda row: row.spacing,
    ),
    Column(
        key="feed_mm_min", heading="feed mm/min", form=".0f",
        value=lambda row: mm_min_from_speed(row.feed),
    ),
    Column(
        key="reached_mm_min", heading="reached mm/min", form=".0f",
        value=lambda row: mm_min_from_speed(row.reached),
    ),
    Column(key="lost_s", heading="lost s", form=".2f", value=lambda row: row.lost),
    Column(key="cause", heading="held by", is_words=True, value=lambda row: row.cause.words),
)  # fmt: skip


def print_cycle_time(result: CycleTimeResult) -> None:
    """Print times by workingstep and tool, the stretches that lose most, and hints."""
    machine = result.machine
    time = "" if machine.block_time is None else f", {1e3 * machine.block_time:g} ms a block"
    print_line(f"{result.name}: machine {machine.name}{time}, control {result.control.value}")
    print_table(ROWS, [*result.rows, result.total])
    if result.stretches:
        print_line("blocks that lose most:")
        print_table(STRETCHES, result.stretches)
    for hint in result.hints:
        print_line(f"hint: {hint}")
    print_findings(result.findings)


def cycle_time_json(result: CycleTimeResult) -> str:
    """Return the times as JSON; keys carry their units."""
    time = result.machine.block_time
    return dump({
        "program": result.name,
        "machine": result.machine.name,
        "control": result.control.value,
        "block_time_ms": None if time is None else 1e3 * time,
        "rows": records(ROWS, result.rows),
        "total": record(ROWS, result.total),
        "stretches": records(STRETCHES, result.stretches),
        "hints": result.hints,
        "findings": [finding_record(each) for each in result.findings],
    })


def cycle_time_page(result: CycleTimeResult) -> str:
    """Return the times as a self-contained page with the feed of each block."""
    from service.blocks.figures import cycle_time_figure  # noqa: PLC0415 (slow to import)

    return rendered(
        "cycletime.html.jinja",
        result=result,
        columns=ROWS,
        stretches=STRETCHES,
        figure=plot(cycle_time_figure(result.times), "feeds"),
    )
