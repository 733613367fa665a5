"""The jobs ``evaluation`` and ``review``: tables of the knowledge base, and proposals."""

import json
from collections.abc import Mapping
from dataclasses import replace
from datetime import datetime
from typing import Any

from kbe.evaluation import Grouping, RowFilter, SortKey
from kbe.selection import NAMES, Selection
from service.files import write_atomically
from service.flat_file import Format, write_rows
from service.jobs.task import REPORT, Task
from service.knowledge.evaluated import TableRequest, table
from service.knowledge.evaluation_export import FIELDS, table_json, table_rows
from service.knowledge.evaluation_page import evaluation_page
from service.knowledge.review import ReviewRequest, review
from service.knowledge.wire import review_json

TABLE = "table"
"""stem of the files for other programs"""

PLACE = "knowledge base of this service"


def run_evaluation(task: Task) -> None:
    """Make the evaluation table in all its forms.

    Raises
    ------
    KnowledgeError, WriteError
        When the knowledge base cannot be read, or the disk refuses.
    """
    asked = task.request
    request = TableRequest(
        selection=selection_of(asked),
        grouping=Grouping(asked["grouping"]),
        keep=RowFilter(asked["only"]),
        by=SortKey(asked["sort"]),
    )
    # Where it lies is nobody's business.
    found = replace(table(task.depot.knowledge, request, tell=task.tell), place=PLACE)
    for form in (Format.CSV, Format.PARQUET):
        file = task.folder / f"{TABLE}.{form.value}"
        write_rows(file, FIELDS, table_rows(found.rows), form=form)
    write_atomically(task.folder / REPORT, evaluation_page(found).encode())
    task.keep(json.loads(table_json(found)))


def run_review(task: Task) -> None:
    """Learn from outcomes, and propose corrections.

    Raises
    ------
    KnowledgeError
        When the knowledge base cannot be read or written.
    """
    request = ReviewRequest(selection=selection_of(task.request), by=task.job.owner)
    found = review(task.depot.knowledge, request)
    task.keep(json.loads(review_json(found)))


def selection_of(asked: Mapping[str, Any]) -> Selection:
    """The outcomes that are meant."""
    return Selection(
        **{name: asked[name] for name in NAMES},
        since=_moment(asked["since"]),
        until=_moment(asked["until"]),
    )


def _moment(text: str | None) -> datetime | None:
    return None if text is None else datetime.fromisoformat(text)
