"""Requests of the knowledge base: selection, evaluation and review of outcomes."""

from dataclasses import dataclass
from datetime import date, datetime, time, timedelta
from typing import TYPE_CHECKING, Annotated

from annotated_types import MaxLen

from kbe.evaluation import Grouping, RowFilter, SortKey
from service.requests.fields import LONGEST_NAME, About, Request
from stepnc_model.errors import StepNcError

if TYPE_CHECKING:
    from kbe.queries import Selection

Wanted = Annotated[str, MaxLen(LONGEST_NAME)] | None

SELECT = "select outcomes that match all of these"
"""Heading of the options that select outcomes."""

NAMED = "name as in the outcomes"


def moment(word: str) -> datetime:
    """Parse a time; a date means the start of the day, no zone that of this computer.

    Raises
    ------
    StepNcError
        When the text is not a time.
    """
    try:
        return _zoned(datetime.fromisoformat(word))
    except (ValueError, OverflowError) as error:
        raise StepNcError(
            f"{word!r} is not a time; write 2026-03-05 or 2026-03-05T14:30+01:00"
        ) from error


def end(word: str) -> datetime:
    """Parse a time; a date means the end of the day.

    Raises
    ------
    StepNcError
        When the text is not a time.
    """
    try:
        day = date.fromisoformat(word)
        return _zoned(datetime.combine(day + timedelta(days=1), time()))
    except OverflowError as error:
        raise StepNcError(f"{word!r} is not a supported time") from error
    except ValueError:
        return moment(word)


def _zoned(when: datetime) -> datetime:
    """Add the local time zone to a time without one; refuse times that have no UTC value."""
    zoned = when.astimezone()
    zoned.timestamp()
    return zoned


@dataclass(frozen=True, slots=True, kw_only=True)
class SelectionRequest(Request):
    """Selection of outcomes that match all given values; null matches any."""

    machine: Annotated[Wanted, About(NAMED, group=SELECT, flag="--machine", metavar="NAME")] = (
        None
    )
    material: Annotated[
        Wanted, About(NAMED, group=SELECT, flag="--material", metavar="NAME")
    ] = None
    tool: Annotated[Wanted, About(NAMED, group=SELECT, flag="--tool", metavar="NAME")] = None
    feature_kind: Annotated[
        Wanted,
        About(
            "EXPRESS name: closed_pocket, slot, planar_face …",
            group=SELECT, flag="--feature-kind", metavar="NAME", examples=("closed_pocket",),
        ),
    ] = None  # fmt: skip
    program: Annotated[
        Wanted, About("file name", group=SELECT, flag="--program", metavar="NAME")
    ] = None
    run: Annotated[
        Wanted, About("id of the run", group=SELECT, flag="--run", metavar="NAME")
    ] = None
    since: Annotated[
        datetime | None,
        About(
            "start time (inclusive), with zone; on the command line 2026-03-05, "
            "2026-03-05T14:30, or with a zone as +01:00 (default: the local time zone)",
            group=SELECT, flag="--since", metavar="TIME", read=moment,
        ),
    ] = None  # fmt: skip
    until: Annotated[
        datetime | None,
        About(
            "end time (exclusive), with zone; on the command line a date includes the day",
            group=SELECT, flag="--until", metavar="TIME", read=end,
        ),
    ] = None  # fmt: skip

    @property
    def selection(self) -> "Selection":
        """Return the selection of outcomes.

        Raises
        ------
        StepNcError
            When the time selected ends before it starts.
        """
        from kbe.queries import Selection  # noqa: PLC0415 (SQLAlchemy)

        if self.since is not None and self.until is not None and self.since >= self.until:
            raise StepNcError(f"since {self.since} is not before until {self.until}")
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

    grouping: Annotated[
        Grouping,
        About(
            "a row for each feature of each program, or for each kind of feature: feature or "
            "kind",
            name="by", flag="--by", metavar="GROUPING",
        ),
    ] = Grouping.FEATURE  # fmt: skip
    only: Annotated[
        RowFilter,
        About(
            "which rows to keep: all, violated, wasted, with remarks, with trend or factor "
            "pending; on the command line with hyphens, with-remarks",
            flag="--only", metavar="RESULT",
        ),
    ] = RowFilter.ALL  # fmt: skip
    sort: Annotated[
        SortKey,
        About(
            "order of the rows: name, grade, runs, latest, force, time, feed, roughness or "
            "time to win",
            flag="--sort", metavar="KEY",
        ),
    ] = SortKey.NAME  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class ReviewRequest(SelectionRequest):
    """Request to propose corrections from selected outcomes."""
