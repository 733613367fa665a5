"""Operations on the knowledge base, one function each.

A place is an SQLite file or the address of a PostgreSQL database, see
:mod:`service.knowledge.place`. Each function opens it, performs one operation, and closes it.
The evaluation table is computed in :mod:`service.knowledge.evaluation_table`, proposals in
:mod:`service.knowledge.review`.
"""

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

from kbe import backup as copies
from kbe.backup import Content
from kbe.connection import parsed_place
from kbe.errors import StoreFull, StoreReadOnly, UnknownCorrection
from kbe.factor import SAFE, factor_at
from kbe.queries import EVERYTHING, Selection, StoredCorrection
from kbe.store import Store, open_store, open_to_read
from service.knowledge.place import is_usual, make_folder
from stepnc_model.errors import StepNcError
from stepnc_model.outcome import Context, LearnedCorrection, ProcessOutcome
from stepnc_model.plurals import counted

CENTURY = timedelta(days=36_525)

FEWEST_LETTERS = 4
"""Fewest characters of an abbreviated run id."""

RECENT = 2000
"""Number of latest outcomes among which an abbreviated run id is searched."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AcceptedFactor:
    """Accepted factor on k_c that a plan applies to one tool."""

    tool: str
    factor: float
    """Factor at the requested quantile."""
    centre: float
    accepted_by: str
    accepted_at: datetime
    outcomes: int
    """Number of outcomes that the factor was learned from."""
    correction: LearnedCorrection
    """Correction that the factor belongs to."""


def accepted_factors(
    place: str,
    *,
    machine: str,
    material: str,
    tools: Iterable[str],
    quantile: float = SAFE,
    is_new_allowed: bool = False,
) -> tuple[AcceptedFactor, ...]:
    """Return the accepted factors for the tools of a plan; tools without one are omitted.

    Parameters
    ----------
    machine, material : str
        Names as in the outcomes.
    tools : iterable of str
        Ids of the tools; duplicates are allowed.
    quantile : float
        Quantile of the next run's factor; at 0.9, one run in ten needs more force than planned.
    is_new_allowed : bool
        Whether a file that does not exist yet is accepted; it has no factors.

    Raises
    ------
    KnowledgeError
        When the knowledge base does not exist or cannot be read.
    """
    file = parsed_place(place).file
    if is_new_allowed and file and not Path(file).exists():
        return ()
    with open_to_read(place) as store:
        found = (
            (tool, store.accepted(Context(machine=machine, material=material, tool=tool)))
            for tool in dict.fromkeys(tools)
        )
        return tuple(
            _factor(tool, correction, quantile)
            for tool, correction in found
            if correction is not None
        )


def _factor(tool: str, correction: LearnedCorrection, quantile: float) -> AcceptedFactor:
    return AcceptedFactor(
        tool=tool,
        factor=factor_at(correction, quantile=quantile),
        centre=factor_at(correction, quantile=0.5),
        accepted_by=correction.accepted_by,
        accepted_at=correction.accepted_at or correction.proposed_at,
        outcomes=correction.outcomes,
        correction=correction,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordCount:
    """Outcomes that were to be recorded, and how many of them are new.

    Examples
    --------
    >>> str(RecordCount(new=3, total=3))
    '3 outcomes'
    >>> str(RecordCount(new=0, total=3))
    '0 outcomes (already recorded: 3 of 3)'
    """

    new: int
    total: int

    def __str__(self) -> str:
        known = self.total - self.new
        known_text = f" (already recorded: {known} of {self.total})" if known else ""
        return f"{counted(self.new, 'outcome')}{known_text}"


def record(place: str, outcomes: Sequence[ProcessOutcome]) -> RecordCount:
    """Store the outcomes of a run, all or none; create the knowledge base if it is new.

    Those that were recorded before are not counted again.

    Raises
    ------
    KnowledgeError, WriteError
        When the outcomes cannot be stored.
    """
    make_folder(place)
    with open_store(place) as store:
        return RecordCount(new=store.add(outcomes), total=len(outcomes))


def require_usable(place: str) -> str:
    """Create the knowledge base if it is new; return why it can only be read, or nothing.

    Raises
    ------
    KnowledgeError
        When it cannot even be read.
    """
    try:
        with open_store(place):
            return ""
    except (StoreFull, StoreReadOnly) as error:
        with open_to_read(place):
            return str(error)


@contextmanager
def readable(place: str) -> Iterator[Store | None]:
    """Open the store for reading; None if the default file does not exist yet."""
    if is_usual(place) and not Path(place).exists():
        yield None
        return
    with open_to_read(place) as store:
        yield store


@dataclass(frozen=True, slots=True, kw_only=True)
class Listing:
    """Latest outcomes of a selection, with the number of all selected outcomes."""

    outcomes: tuple[ProcessOutcome, ...]
    total: int


def newest(place: str, selection: Selection, *, limit: int) -> Listing:
    """Return the latest outcomes of a selection, newest first.

    Raises
    ------
    KnowledgeError
        When the knowledge base cannot be opened or read; this holds for all functions below. A
        missing default file counts as an empty knowledge base.
    """
    with readable(place) as store:
        if store is None:
            return Listing(outcomes=(), total=0)
        groups = store.groups(selection)
        total = sum(group.outcomes for group in groups)
        if not total or not limit:
            return Listing(outcomes=(), total=total)
        end = max(group.last for group in groups)
        recent = _recent(store, selection, end=end, at_least=min(limit, total))
        last = deque(store.outcomes(recent), maxlen=limit)
        return Listing(outcomes=tuple(reversed(last)), total=total)


def _recent(store: Store, selection: Selection, *, end: datetime, at_least: int) -> Selection:
    """Limit a selection to a recent period with at least the requested number of outcomes.

    A store returns outcomes oldest first, but counts those of a period quickly.
    """
    span = timedelta(hours=1)
    while span < CENTURY:
        recent = replace(selection, since=end - span)
        if selection.since is not None and selection.since >= end - span:
            return selection
        if store.count(recent) >= at_least:
            return recent
        span *= 4
    return selection


def outcomes_of_run(place: str, run: str) -> tuple[ProcessOutcome, ...]:
    """Return all outcomes of a run, in order of time; empty if the run does not exist.

    Parameters
    ----------
    run : str
        Id of the run, or the first four or more characters of a recent run's id.

    Raises
    ------
    StepNcError
        When several recent runs match an abbreviated id.
    """
    found = _of_run(place, run)
    if found or len(run) < FEWEST_LETTERS:
        return found
    recent = newest(place, EVERYTHING, limit=RECENT).outcomes
    meant = sorted({each.run for each in recent if each.run.startswith(run)})
    if len(meant) > 1:
        raise StepNcError(f"several runs begin with '{run}': {', '.join(meant[:5])}")
    return _of_run(place, meant[0]) if meant else ()


def _of_run(place: str, run: str) -> tuple[ProcessOutcome, ...]:
    """Return the outcomes of a run by its complete id."""
    with readable(place) as store:
        return () if store is None else tuple(store.outcomes(Selection(run=run)))


@contextmanager
def selected_outcomes(place: str, selection: Selection) -> Iterator[Iterator[ProcessOutcome]]:
    """Provide an iterator over selected outcomes while the knowledge base is open."""
    with readable(place) as store:
        yield iter(()) if store is None else store.outcomes(selection)


def corrections(place: str) -> tuple[StoredCorrection, ...]:
    """Return all corrections with their latest decisions, in the order of their proposal."""
    with readable(place) as store:
        return () if store is None else store.corrections()


def contexts(place: str) -> tuple[Context, ...]:
    """Return all combinations of machine, material and tool that have outcomes."""
    with readable(place) as store:
        return () if store is None else store.contexts()


def accept(place: str, ids: Sequence[int], *, by: str) -> tuple[StoredCorrection, ...]:
    """Accept corrections in the name of a person; all or none.

    Raises
    ------
    UnknownCorrection
        When an id is unknown.
    """
    with open_store(place, is_new_allowed=False) as store:
        _require_known(store, ids)
        for each in ids:
            store.accept(each, by=by, at=datetime.now(UTC))
        return _entries(store, ids)


def withdraw(place: str, ids: Sequence[int], *, by: str) -> tuple[StoredCorrection, ...]:
    """Withdraw accepted corrections, or reject proposals; raises as :func:`accept`."""
    with open_store(place, is_new_allowed=False) as store:
        _require_known(store, ids)
        for each in ids:
            store.withdraw(each, by=by, at=datetime.now(UTC))
        return _entries(store, ids)


def _require_known(store: Store, ids: Sequence[int]) -> None:
    """Refuse unknown ids before anything is decided."""
    known = {entry.id for entry in store.corrections()}
    for each in ids:
        if each not in known:
            raise UnknownCorrection(store.place.shown, id=each)


def _entries(store: Store, ids: Sequence[int]) -> tuple[StoredCorrection, ...]:
    by_id = {entry.id: entry for entry in store.corrections()}
    return tuple(by_id[each] for each in dict.fromkeys(ids))


def back_up(place: str, file: Path) -> Content:
    """Copy the knowledge base to a new file."""
    with open_to_read(place) as store:
        return copies.backup(store, str(file))


def restore(file: Path, place: str) -> Content:
    """Fill an empty knowledge base from a backup."""
    make_folder(place)
    return copies.restore(str(file), place)


def check(place: str) -> Content:
    """Check the integrity of all stored data and return the numbers of entries.

    Raises
    ------
    StoreDamaged
        When the stored data are damaged.
    """
    with open_to_read(place) as store:
        store.check()
        return copies.content(store)


def shown(place: str) -> str:
    """Return the location for display, without its password."""
    return parsed_place(place).shown
