"""The knowledge base as its users see it, in both databases."""

from collections.abc import Callable
from dataclasses import replace
from datetime import timedelta
from threading import Thread

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from sqlalchemy import text as text_of

from kbe.connection import writing
from kbe.errors import StoreDamaged, StoreUnavailable
from kbe.queries import Selection
from kbe.schema import outcome as outcome_table
from kbe.store import AT_ONCE, Store, open_store
from stepnc_model.outcome import Context, EvaluatedQuantity, ProcessOutcome

OutcomeMaker = Callable[..., list[ProcessOutcome]]


def test_outcomes_come_back_by_time(store: Store, outcomes: OutcomeMaker) -> None:
    kept = outcomes(5)
    store.add(kept[3:])
    store.add(kept[:3])
    store.add([])
    assert list(store.outcomes()) == kept
    assert store.count() == 5


def test_outcomes_of_the_same_moment_come_as_they_were_added(
    store: Store, outcomes: OutcomeMaker
) -> None:
    kept = [replace(each, recorded_at=outcomes(1)[0].recorded_at) for each in outcomes(4)]
    store.add(kept[::-1])
    assert list(store.outcomes()) == kept[::-1]


texts = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=9)
numbers = st.none() | st.floats(-1e300, 1e300, allow_subnormal=False)


# One store for all examples: each looks for its own run.
@settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    text=texts,
    number=numbers,
    count=st.integers(0, 2**62),
    immersion=st.booleans(),
    microseconds=st.integers(0, 10**15),
)
def test_every_text_number_and_time_comes_back_to_the_last_bit(  # noqa: PLR0917
    store: Store,
    outcome: ProcessOutcome,
    text: str,
    number: float | None,
    count: int,
    immersion: bool,
    microseconds: int,
) -> None:
    assert outcome.force_ratio is not None
    kept = replace(
        outcome,
        program=text,
        run=f"run {store.count()}",
        specific_force=number,
        step_depth=EvaluatedQuantity(measured=number),
        immersion=outcome.immersion if immersion else None,
        force_ratio=replace(outcome.force_ratio, readings=count) if immersion else None,
        recorded_at=outcome.recorded_at + timedelta(microseconds=microseconds),
    )
    store.add([kept])
    assert list(store.outcomes(Selection(run=kept.run))) == [kept]


def test_batch_is_kept_whole_or_not_at_all(store: Store, outcomes: OutcomeMaker) -> None:
    bad = replace(outcomes(1)[0], force=EvaluatedQuantity(measured=float("nan")))
    with pytest.raises(ValueError, match="nan"):
        store.add([*outcomes(3), bad])
    assert store.count() == 0


def test_reading_sees_one_moment_while_others_write(
    store: Store, outcomes: OutcomeMaker
) -> None:
    """More than is fetched at once, so that the rest is read after the write."""
    store.add(outcomes(AT_ONCE + 50))
    stream = store.outcomes()
    next(stream)
    store.add(outcomes(10, run="run-2"))
    assert sum(1 for _ in stream) == AT_ONCE + 49
    assert store.count() == AT_ONCE + 60


def test_stream_that_is_left_keeps_nobody_waiting(store: Store, outcomes: OutcomeMaker) -> None:
    store.add(outcomes(3))
    for _ in range(40):
        next(store.outcomes())
    store.add(outcomes(1, run="run-2"))
    assert store.count() == 4


def test_contexts_are_told_once_each(store: Store, outcomes: OutcomeMaker) -> None:
    other = Context(machine="vmc15", material="Al", tool="endmill 16")
    store.add([replace(each, context=other) for each in outcomes(2, run="run-2")] + outcomes(2))
    assert store.contexts() == (other, outcomes(1)[0].context)


def test_threads_share_a_store(store: Store, outcomes: OutcomeMaker) -> None:
    def write(run: str) -> None:
        for each in outcomes(10, run=run):
            store.add([each])

    threads = [Thread(target=write, args=(f"run-{index}",)) for index in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len({each.workingstep for each in store.outcomes()}) == store.count() == 40


def test_whole_store_passes_its_check(store: Store, outcomes: OutcomeMaker) -> None:
    store.add(outcomes(20))
    store.check()


def test_row_that_is_no_outcome_is_damage(store: Store, outcomes: OutcomeMaker) -> None:
    """Another program may add rows; what they hold is not beyond doubt."""
    store.add(outcomes(1))
    columns = [column.name for column in outcome_table.columns if column.name != "id"]
    change = {"immersion": "'SIDEWAYS'", "sequence": "1"}
    values = ", ".join(change.get(name, name) for name in columns)
    with writing(store.engine, store.place) as connection:
        names = ", ".join(columns)
        connection.execute(
            text_of(f"INSERT INTO outcome ({names}) SELECT {values} FROM outcome")
        )
    with pytest.raises(StoreDamaged, match="a row cannot be read"):
        list(store.outcomes())


def test_what_cannot_be_opened_says_so() -> None:
    with pytest.raises(StoreUnavailable, match="name a file"):
        open_store("mysql://ann@db/kbe")
