"""The evaluation table and its summary in the form that was asked for, to stdout or a file."""

import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from kbe.selection import Selection
from service.files import write_atomically
from service.flat_file import Field, Format, Row, csv_lines, write_rows
from service.knowledge.evaluated import TableRequest, summary, table
from service.knowledge.place import require_apart
from service.reading import Tell
from service.terminal import write_out
from stepnc_model.errors import StepNcError


def put_table(
    place: str, request: TableRequest, *, form: str, output: Path | None, tell: Tell
) -> int:
    """Make the table and put it where it is wanted; how many outcomes it is of.

    Raises
    ------
    KnowledgeError, WriteError
        When it cannot be made, or not be written.
    """
    _require_output(form, output)
    require_apart(place, output)
    found = table(place, request, tell=tell)
    if form in {Format.CSV, Format.PARQUET}:
        from service.knowledge.evaluation_export import FIELDS, table_rows  # noqa: PLC0415

        _put_rows(FIELDS, table_rows(found.rows), form=Format(form), output=output)
    elif form == Format.JSON:
        from service.knowledge.evaluation_export import table_json  # noqa: PLC0415

        _put(table_json(found), output)
    elif form == "html":
        from service.knowledge.evaluation_page import evaluation_page  # noqa: PLC0415 (plotly)

        _put(evaluation_page(found), output)
    elif found.outcomes or output is not None:
        from service.knowledge.evaluation_table import (  # noqa: PLC0415
            screen_width,
            table_text,
            wants_colours,
        )

        is_file = output is not None
        width = sys.maxsize if is_file else screen_width()
        _put(
            table_text(found, width=width, is_coloured=not is_file and wants_colours()), output
        )
    return found.outcomes


def put_summary(place: str, selection: Selection, *, form: str, output: Path | None) -> int:
    """The same for the summary."""
    _require_output(form, output)
    require_apart(place, output)
    if form == "html" or (form == "text" and output is not None):
        raise StepNcError("a summary in a file is CSV, JSON or Parquet")
    found = summary(place, selection)
    if form in {Format.CSV, Format.PARQUET}:
        from service.knowledge.evaluation_summary import SUMMARY_FIELDS, summary_rows  # noqa: PLC0415

        rows = summary_rows(found.groups)
        _put_rows(SUMMARY_FIELDS, rows, form=Format(form), output=output)
    elif form == Format.JSON:
        from service.knowledge.evaluation_summary import summary_json  # noqa: PLC0415

        _put(summary_json(found), output)
    elif found.groups:
        from service.knowledge.evaluation_summary import print_summary  # noqa: PLC0415

        print_summary(found)
    return len(found.groups)


def _require_output(form: str, output: Path | None) -> None:
    """Bytes are not for a terminal."""
    if form == Format.PARQUET and output is None:
        raise StepNcError("Parquet goes to a file; name it: -o FILE.parquet")


def _put(text: str, output: Path | None) -> None:
    if output is None:
        sys.stdout.write(text + "\n")
    else:
        write_atomically(output, f"{text}\n".encode())


def _put_rows(
    fields: Sequence[Field], rows: Iterable[Row], *, form: Format, output: Path | None
) -> None:
    if output is not None:
        write_rows(output, fields, rows, form=form)
        return
    for line in csv_lines(fields, rows):
        write_out(line)
