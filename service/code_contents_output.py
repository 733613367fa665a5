"""Contents and findings of NC code as text and JSON, for the command ``check``."""

from math import isnan

from service.code_contents import CodeContents, MoveCount
from service.rendering.columns import Column
from service.rendering.records import dump, finding_record, records
from service.rendering.text import print_findings, print_line, print_table
from stepnc_model.units import mm_min_from_speed

COUNTS: tuple[Column[MoveCount], ...] = (
    Column(
        key="tool",
        heading="tool",
        value=lambda row: None if row.tool < 0 else row.tool,
        form="d",
        is_key=True,
    ),
    Column(key="kind", heading="moves", value=lambda row: row.kind, is_key=True),
    Column(key="count", heading="number", value=lambda row: row.count, form="d"),
    Column(key="length_mm", heading="length mm", value=lambda row: row.length, form=".0f"),
    Column(
        key="least_feed_mm_min",
        heading="least feed mm/min",
        value=lambda row: _feed(row.least_feed),
        form=".0f",
    ),
    Column(
        key="greatest_feed_mm_min",
        heading="greatest feed mm/min",
        value=lambda row: _feed(row.greatest_feed),
        form=".0f",
    ),
    Column(
        key="advisable", heading="feed may change", value=lambda row: row.advisable, form="d"
    ),
    Column(
        key="splittable", heading="may be split", value=lambda row: row.splittable, form="d"
    ),
)


def print_code(contents: CodeContents) -> None:
    """Print the contents and findings of NC code."""
    hints = f" (guessed from {', '.join(contents.hints)})" if contents.hints else ""
    print_line(
        f"{contents.name}: {contents.control} {contents.machine}{hints}, "
        f"{'inch' if contents.is_inch else 'mm'}, {contents.blocks} blocks, "
        f"{contents.executed} executed moves, frames {', '.join(contents.frames)}"
    )
    print_table(COUNTS, list(contents.counts))
    print_findings(contents.findings)
    print_line(
        "rewriting without advice gives the file byte for byte"
        if contents.is_lossless
        else "rewriting does not give the file byte for byte: please report this"
    )


def code_json(contents: CodeContents) -> str:
    """Return the contents and findings of NC code as JSON."""
    return dump({
        "program": contents.name,
        "control": contents.control,
        "hints": list(contents.hints),
        "machine": contents.machine,
        "units": "inch" if contents.is_inch else "mm",
        "blocks": contents.blocks,
        "executed_moves": contents.executed,
        "frames": list(contents.frames),
        "moves": records(COUNTS, contents.counts),
        "is_lossless": contents.is_lossless,
        "findings": [finding_record(finding) for finding in contents.findings],
    })


def _feed(speed: float) -> float | None:
    """Feed in mm/min, or None where it is not known."""
    return None if isnan(speed) else mm_min_from_speed(speed)
