"""Export of outcomes, corrections or the evaluation table to a file."""

from kbe.schema import DECIDED
from service.knowledge.columns import CORRECTION_COLUMNS, OUTCOME_COLUMNS
from service.knowledge.place import require_apart
from service.knowledge.verbs import corrections, selected_outcomes
from service.outputs.flat_file import Format, write_rows
from service.outputs.output_format import format_of
from service.progress import Tell, silent
from service.rendering.columns import file_columns, file_rows
from service.verbs.kbe.export.request import ExportedContent, ExportFiles, ExportRequest
from service.verbs.kbe.export.result import ExportResult
from service.verbs.kbe.table.request import TableFiles
from service.verbs.kbe.table.run import run as table
from stepnc_model.errors import StepNcError

EXPORTED = sorted(
    (each for each in CORRECTION_COLUMNS if each.key not in DECIDED),
    key=lambda each: each.key != "id",
)
"""Columns of corrections in files: the id first, the latest decision once."""


def run(request: ExportRequest, files: ExportFiles, *, tell: Tell = silent) -> ExportResult:
    """Write a file; outcomes and corrections row by row, in bounded memory.

    Raises
    ------
    StepNcError
        When the knowledge base cannot be read, or the file cannot have this format or be
        written.
    """
    rows: int | None = None
    if request.what is ExportedContent.TABLE:
        _write_table(request, files, tell=tell)
    else:
        rows = _write_rows(request, files)
    return ExportResult(written=files.output, what=request.what, rows=rows)


def _write_table(request: ExportRequest, files: ExportFiles, *, tell: Tell) -> None:
    form = files.format or format_of(files.output)
    places = TableFiles(kb=files.kb, output=files.output, format=form, summary=files.summary)
    table(request, places, tell=tell).save(files.output, form)


def _write_rows(request: ExportRequest, files: ExportFiles) -> int:
    name = (files.format or format_of(files.output)).value
    if name not in [each.value for each in Format]:
        raise StepNcError(f"outcomes and corrections cannot be written as {name}")
    form = Format(name)
    require_apart(files.place, files.output)
    if request.what is ExportedContent.CORRECTIONS:
        entries = corrections(files.place)
        columns = file_columns(EXPORTED)
        return write_rows(files.output, columns, file_rows(EXPORTED, entries), form=form)
    with selected_outcomes(files.place, request.selection) as found:
        columns, values = file_columns(OUTCOME_COLUMNS), file_rows(OUTCOME_COLUMNS, found)
        return write_rows(files.output, columns, values, form=form)
