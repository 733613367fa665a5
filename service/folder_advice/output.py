"""Advice for a folder as text and JSON."""

from service.folder_advice.ledger import ProgramRow
from service.folder_advice.run import FolderAdvice
from service.rendering.columns import Change, Column
from service.rendering.records import dump, records
from service.rendering.text import print_line, print_table

ROWS: tuple[Column[ProgramRow], ...] = (
    Column(key="program", heading="program", is_key=True, kind=str,
           value=lambda row: row.program),
    Column(key="status", heading="status", kind=str, value=lambda row: row.status.value),
    Column(key="workingsteps", heading="workingsteps", form="d", is_right=True,
           value=lambda row: row.workingsteps),
    Column(key="advised", heading="advised", form="d", is_right=True,
           value=lambda row: row.advised),
    Column(key="time_before_s", value=lambda row: row.time_before_s),
    Column(key="time_after_s", value=lambda row: row.time_after_s),
    Column(heading="time s", form=".1f", is_right=True,
           value=lambda row: Change(before=row.time_before_s, after=row.time_after_s)),
    Column(key="message", value=lambda row: row.message),
)  # fmt: skip


def print_folder_advice(found: FolderAdvice) -> None:
    """Print a row for each program, then what was wrong."""
    before = sum(row.time_before_s for row in found.rows)
    after = sum(row.time_after_s for row in found.rows)
    foot = {"program": "total", "time s": f"{before:.1f} -> {after:.1f}"}
    print_table(ROWS, found.rows, foot=foot)
    for row in found.rows:
        if row.message:
            print_line(f"  {row.program}: {row.message}")
    known = len(found.rows) - found.made
    if known:
        print_line(f"{known} of the programs had been optimised before, with the same options")


def folder_advice_json(found: FolderAdvice) -> str:
    """JSON with a record for each program."""
    return dump({"programs": records(ROWS, found.rows), "made": found.made})
