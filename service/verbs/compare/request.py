"""Request of ``compare``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from annotated_types import MaxLen

from service.requests.fields import About, FileUse, Request
from service.requests.output import OutputFiles

MOST_PLANS = 12


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparisonRequest(Request):
    """Request to compare plans; there is nothing to choose."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparisonFiles(OutputFiles):
    """Files of ``compare``."""

    plans: Annotated[
        tuple[Path, ...],
        MaxLen(MOST_PLANS),
        About("plans as JSON, of `optimise --json`", use=FileUse.INPUT, metavar="PLAN.json"),
    ]


REQUEST, FILES = ComparisonRequest, ComparisonFiles
