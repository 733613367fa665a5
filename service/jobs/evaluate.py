"""Job ``evaluation``: tables of the knowledge base."""

import json
from dataclasses import replace

from service.files import write_atomically
from service.flat_file import Format, write_rows
from service.jobs.task import REPORT, RunningJob
from service.knowledge.evaluated import table
from service.knowledge.evaluation_columns import FILE_COLUMNS, lines
from service.knowledge.evaluation_output import evaluation_page, table_json
from service.rendering.records import file_columns, file_rows
from service.requests.knowledge import EvaluationRequest

TABLE = "table"
"""File name stem of the tables for other programs."""

PLACE = "knowledge base of this service"


def run(task: RunningJob) -> None:
    """Compute the evaluation table and write it in all formats.

    Raises
    ------
    KnowledgeError, WriteError
        When the knowledge base cannot be read, or the disk refuses.
    """
    request = task.request(EvaluationRequest)
    # Clients must not learn the location of the knowledge base.
    found = replace(table(task.data_folder.knowledge, request, tell=task.tell), place=PLACE)
    for form in (Format.CSV, Format.PARQUET):
        file = task.folder / f"{TABLE}.{form.value}"
        rows = file_rows(FILE_COLUMNS, lines(found.rows))
        write_rows(file, file_columns(FILE_COLUMNS), rows, form=form)
    write_atomically(task.folder / REPORT, evaluation_page(found).encode())
    task.keep(json.loads(table_json(found)))
