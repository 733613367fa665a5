"""Requests of the knowledge base: selection, evaluation and review of outcomes."""

from dataclasses import dataclass
from datetime import datetime
from typing import Annotated

from annotated_types import MaxLen

from kbe.evaluation import Grouping, RowFilter, SortKey
from kbe.selection import Selection
from service.requests.fields import LONGEST_NAME, About, Request

Wanted = Annotated[str, MaxLen(LONGEST_NAME)] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class SelectionRequest(Request):
    """Selection of outcomes that match all given values; null matches any."""

    machine: Wanted = None
    material: Wanted = None
    tool: Wanted = None
    feature_kind: Annotated[Wanted, About("EXPRESS name", examples=("closed_pocket",))] = None
    program: Wanted = None
    run: Wanted = None
    since: Annotated[datetime | None, About("start time (inclusive), with zone")] = None
    until: Annotated[datetime | None, About("end time (exclusive), with zone")] = None

    @property
    def selection(self) -> Selection:
        """Return the selection of outcomes."""
        return Selection(
            machine=self.machine,
            material=self.material,
            tool=self.tool,
            feature_kind=self.feature_kind,
            program=self.program,
            run=self.run,
            since=self.since,
            until=self.until,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluationRequest(SelectionRequest):
    """Request of an evaluation table."""

    grouping: Annotated[Grouping, About("feature or kind of feature")] = Grouping.FEATURE
    only: Annotated[RowFilter, About("which rows to keep")] = RowFilter.ALL
    sort: Annotated[SortKey, About("sort key of the rows")] = SortKey.NAME


@dataclass(frozen=True, slots=True, kw_only=True)
class ReviewRequest(SelectionRequest):
    """Request to propose corrections from selected outcomes."""
