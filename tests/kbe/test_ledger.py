"""Corrections and what is decided about them."""

from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from itertools import count
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kbe.errors import StoreDamaged, UnknownCorrection
from kbe.queries import Standing
from kbe.store import Store, open_store
from stepnc_model.outcome import LearnedCorrection

LATER = datetime(2026, 4, 1, tzinfo=UTC)


def test_proposal_is_not_in_force(store: Store, proposal: LearnedCorrection) -> None:
    id_ = store.propose(proposal)
    (entry,) = store.corrections()
    assert (entry.id, entry.correction, entry.standing) == (id_, proposal, Standing.PROPOSED)
    assert (entry.decided_by, entry.decided_at) == ("", None)
    assert store.accepted(proposal.context) is None


def test_accepted_is_in_force_with_who_and_when(
    store: Store, proposal: LearnedCorrection
) -> None:
    store.accept(store.propose(proposal), by="Ann", at=LATER)
    found = store.accepted(proposal.context)
    assert found == replace(proposal, accepted_by="Ann", accepted_at=LATER)
    assert store.accepted(replace(proposal.context, tool="other")) is None


def test_withdrawing_puts_the_one_before_in_force_again(
    store: Store, proposal: LearnedCorrection
) -> None:
    first, second = (
        store.propose(replace(proposal, log_centre=centre)) for centre in (0.1, 0.2)
    )
    # What was decided last counts, not what was proposed last.
    store.accept(second, by="Ann", at=LATER)
    store.accept(first, by="Bob", at=LATER)
    assert in_force(store, proposal) == 0.1
    store.withdraw(first, by="Ann", at=LATER)
    assert in_force(store, proposal) == 0.2
    store.withdraw(second, by="Ann", at=LATER + timedelta(days=1))
    assert in_force(store, proposal) is None
    entry = store.corrections()[1]
    assert entry.standing is Standing.WITHDRAWN
    assert (entry.decided_by, entry.decided_at) == ("Ann", LATER + timedelta(days=1))
    assert entry.correction.accepted_by == ""
    assert entry.correction.accepted_at is None


def in_force(store: Store, proposal: LearnedCorrection) -> float | None:
    found = store.accepted(proposal.context)
    return None if found is None else found.log_centre


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    with open_store(str(tmp_path_factory.mktemp("ledger") / "kbe.db")) as store:
        yield store


steps = st.lists(st.tuples(st.booleans(), st.integers(0, 2)), max_size=8)


TOOLS = count()
"""one for each example: they share a store"""


@settings(max_examples=40)
@given(steps=steps)
def test_in_force_is_the_last_accepted_not_withdrawn(
    shared: Store, proposal: LearnedCorrection, steps: list[tuple[bool, int]]
) -> None:
    """Against a list from which a withdrawn one is taken, and to whose end an accepted goes."""
    own = replace(proposal, context=replace(proposal.context, tool=f"endmill {next(TOOLS)}"))
    standing: list[int] = []
    ids = [shared.propose(replace(own, log_centre=float(index))) for index in range(3)]
    for is_accepted, index in steps:
        standing = [each for each in standing if each != index]
        if is_accepted:
            standing.append(index)
            shared.accept(ids[index], by="Ann", at=LATER)
        else:
            shared.withdraw(ids[index], by="Ann", at=LATER)
    assert in_force(shared, own) == (float(standing[-1]) if standing else None)


def test_decision_needs_a_correction_a_person_and_a_zone(
    store: Store, proposal: LearnedCorrection
) -> None:
    id_ = store.propose(proposal)
    with pytest.raises(UnknownCorrection) as caught:
        store.accept(id_ + 1, by="Ann", at=LATER)
    assert caught.value.id == id_ + 1
    with pytest.raises(ValueError, match="name of the person who decides"):
        store.withdraw(id_, by=" ", at=LATER)
    # Once stored it could never be read again, nor taken away.
    with pytest.raises(ValueError, match="cannot be stored as text"):
        store.accept(id_, by="A\0nn", at=LATER)
    with pytest.raises(ValueError, match="no time zone"):
        store.accept(id_, by="Ann", at=datetime(2026, 1, 1))
    assert store.corrections()[0].standing is Standing.PROPOSED


def test_proposal_cannot_be_accepted_already(store: Store, proposal: LearnedCorrection) -> None:
    with pytest.raises(ValueError, match="must not be accepted already"):
        store.propose(replace(proposal, accepted_by="Ann", accepted_at=LATER))
    assert store.corrections() == ()


@pytest.mark.parametrize(
    "wrong",
    [{"log_scale": 0.0}, {"degrees": 0.0}, {"log_centre": 1e6}, {"confidence": 7.0}],
)
def test_a_correction_that_nobody_learned_is_damage(
    tmp_path: Path, proposal: LearnedCorrection, wrong: dict[str, float]
) -> None:
    with open_store(str(tmp_path / "store.db")) as store:
        store.propose(replace(proposal, **wrong))  # type: ignore[arg-type]
        with pytest.raises(StoreDamaged, match="has values out of range"):
            store.corrections()
