"""Request of ``kbe review``."""

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Interval

from service.requests.fields import About
from service.requests.knowledge import ReviewRequest
from service.verbs.kbe.places import DeciderFiles
from stepnc_model.errors import StepNcError

ACCEPT = "accept proposals without a person"
"""Heading of the options of automatic acceptance."""


def share(word: str) -> float:
    """Parse a share such as 0.25 or 25%.

    Raises
    ------
    StepNcError
        When the text is not a number.
    """
    try:
        return float(word.removesuffix("%")) / (100.0 if word.endswith("%") else 1.0)
    except ValueError as error:
        raise StepNcError(f"{word!r} is not a share from 0 to 1, or 0% to 100%") from error


@dataclass(frozen=True, slots=True, kw_only=True)
class ReviewFiles(DeciderFiles):
    """Knowledge base, and on what conditions proposals are accepted at once."""

    auto_accept: Annotated[
        bool,
        About(
            "accept proposals within the three bounds below; others wait for a person",
            group=ACCEPT, flag="--auto-accept",
        ),
    ] = False  # fmt: skip
    least_confidence: Annotated[
        float,
        Interval(ge=0.0, le=1.0),
        About("0 to 1", group=ACCEPT, flag="--least-confidence", metavar="P", read=share),
    ] = 0.8
    fewest_outcomes: Annotated[
        int,
        Interval(ge=0, le=1_000_000_000),
        About(
            "outcomes that support a proposal",
            group=ACCEPT, flag="--fewest-outcomes", metavar="N",
        ),
    ] = 3  # fmt: skip
    greatest_change: Annotated[
        float,
        Interval(ge=0.0, le=1.0),
        About(
            "change of the accepted factor, as 0.25 or 25%",
            group=ACCEPT, flag="--greatest-change", metavar="SHARE", read=share,
        ),
    ] = 0.25  # fmt: skip


REQUEST, FILES = ReviewRequest, ReviewFiles
