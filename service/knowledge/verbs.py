"""Verbs of the knowledge base: one function each.

A place is a file of SQLite or the address of a PostgreSQL database, see
:mod:`service.knowledge.place`. Each function opens it, does one thing, and closes it. The
table is made in :mod:`service.knowledge.evaluated`, proposals in
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
from kbe.errors import UnknownCorrection
from kbe.factor import SAFE, factor_at
from kbe.ledger import StoredCorrection
from kbe.selection import EVERYTHING, Selection
from kbe.store import Store, open_store
from kbe.store_location import parsed_place
from service.knowledge.place import is_usual, make_folder
from stepnc_model.errors import StepNcError
from stepnc_model.outcome import Context, LearnedCorrection, ProcessOutcome

CENTURY = timedelta(days=36_525)

FEWEST_LETTERS = 4
"""of the beginning of a run's id"""

RECENT = 2000
"""outcomes among which a run is found by the beginning of its id"""


@dataclass(frozen=True, slots=True, kw_only=True)
class AcceptedFactor:
    """The factor on k_c that a plan takes for one tool."""

    tool: str
    factor: float
    """at the quantile that was asked for"""
    centre: float
    accepted_by: str
    accepted_at: datetime
    outcomes: int
    """that it was learned from"""
    correction: LearnedCorrection
    """all of it"""


def accepted_factors(
    place: str,
    *,
    machine: str,
    material: str,
    tools: Iterable[str],
    quantile: float = SAFE,
    is_new_allowed: bool = False,
) -> tuple[AcceptedFactor, ...]:
    """Factors in force for the tools of a plan; a tool without one is left out.

    Parameters
    ----------
    place : str
    machine, material : str
        As outcomes name them.
    tools : iterable of str
        Each once, or more often.
    quantile : float
        Of the next run's factor; at 0.9 one run in ten needs more force than planned.
    is_new_allowed : bool
        Whether it may be a file that is still to be made: then nothing is known yet.

    Raises
    ------
    KnowledgeError
        When there is no knowledge base, or it cannot be read.
    """
    file = parsed_place(place).file
    if is_new_allowed and file and not Path(file).exists():
        return ()
    with open_store(place, is_new_allowed=False) as store:
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


def record(place: str, outcomes: Sequence[ProcessOutcome]) -> None:
    """Keep what a run showed, all of it or nothing; makes the knowledge base when it is new.

    Raises
    ------
    KnowledgeError, WriteError
        When it cannot be kept.
    """
    make_folder(place)
    with open_store(place) as store:
        store.add(outcomes)


@contextmanager
def readable(place: str) -> Iterator[Store | None]:
    """The store; None: it is the usual file, and nothing was ever kept in it."""
    if is_usual(place) and not Path(place).exists():
        yield None
        return
    with open_store(place, is_new_allowed=False) as store:
        yield store


@dataclass(frozen=True, slots=True, kw_only=True)
class Listing:
    """Some outcomes, newest first, of all that were meant."""

    outcomes: tuple[ProcessOutcome, ...]
    total: int


def newest(place: str, selection: Selection, *, limit: int) -> Listing:
    """The outcomes that were recorded last, newest first.

    Raises
    ------
    KnowledgeError
        As for all that follow: when the knowledge base cannot be opened or read. The usual
        file of a user who has kept nothing yet counts as an empty one.
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
    """The selection since a moment that leaves about as many outcomes as are wanted.

    A store tells outcomes oldest first, but counts those since a moment at once.
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
    """All of one run, in time; empty: there is no such run.

    Parameters
    ----------
    place : str
    run : str
        Its id; of a recent one the beginning will do, at least four letters.

    Raises
    ------
    StepNcError
        When several recent runs begin so.
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
    """By its whole id."""
    with readable(place) as store:
        return () if store is None else tuple(store.outcomes(Selection(run=run)))


@contextmanager
def selected_outcomes(place: str, selection: Selection) -> Iterator[Iterator[ProcessOutcome]]:
    """Outcomes to read one after the other, while the knowledge base is open."""
    with readable(place) as store:
        yield iter(()) if store is None else store.outcomes(selection)


def corrections(place: str) -> tuple[StoredCorrection, ...]:
    """All corrections and what was decided about them, in the order of their proposal."""
    with readable(place) as store:
        return () if store is None else store.corrections()


def contexts(place: str) -> tuple[Context, ...]:
    """Machines, materials and tools of which something is known."""
    with readable(place) as store:
        return () if store is None else store.contexts()


def accept(place: str, ids: Sequence[int], *, by: str) -> tuple[StoredCorrection, ...]:
    """Put corrections in force in the name of a person; none when one is not known.

    Raises
    ------
    UnknownCorrection
        When there is none of an id.
    """
    with open_store(place, is_new_allowed=False) as store:
        _require_known(store, ids)
        for each in ids:
            store.accept(each, by=by, at=datetime.now(UTC))
        return _entries(store, ids)


def withdraw(place: str, ids: Sequence[int], *, by: str) -> tuple[StoredCorrection, ...]:
    """Take corrections out of force, or refuse proposals; errors as :func:`accept`."""
    with open_store(place, is_new_allowed=False) as store:
        _require_known(store, ids)
        for each in ids:
            store.withdraw(each, by=by, at=datetime.now(UTC))
        return _entries(store, ids)


def _require_known(store: Store, ids: Sequence[int]) -> None:
    """Refuse before the first is decided about."""
    known = {entry.id for entry in store.corrections()}
    for each in ids:
        if each not in known:
            raise UnknownCorrection(store.place.shown, id=each)


def _entries(store: Store, ids: Sequence[int]) -> tuple[StoredCorrection, ...]:
    by_id = {entry.id: entry for entry in store.corrections()}
    return tuple(by_id[each] for each in dict.fromkeys(ids))


def back_up(place: str, file: Path) -> Content:
    """Copy the knowledge base to a new file."""
    with open_store(place, is_new_allowed=False) as store:
        return copies.backup(store, str(file))


def restore(file: Path, place: str) -> Content:
    """Fill an empty knowledge base from a backup."""
    make_folder(place)
    return copies.restore(str(file), place)


def check(place: str) -> Content:
    """Read all that is stored, to the last page; what there is.

    Raises
    ------
    StoreDamaged
        When it is not whole.
    """
    with open_store(place, is_new_allowed=False) as store:
        store.check()
        return copies.content(store)


def shown(place: str) -> str:
    """The place as people may see it: without its password."""
    return parsed_place(place).shown
