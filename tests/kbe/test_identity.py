"""An outcome that is recorded again is counted once."""

import sqlite3
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from datetime import timedelta

import pytest
from sqlalchemy import text

from kbe.connection import writing
from kbe.errors import OutcomeDiffers
from kbe.schema import outcome as outcome_table
from kbe.store import Store, open_store
from stepnc_model.outcome import EvaluatedQuantity, ProcessOutcome
from tests.kbe.test_concurrency import started
from tests.service.waiting import ended

OutcomeMaker = Callable[..., list[ProcessOutcome]]
UrlMaker = Callable[[], str]


def test_a_repeat_adds_nothing_and_says_how_much_is_new(
    store: Store, outcomes: OutcomeMaker
) -> None:
    kept = outcomes(3)
    assert store.add(kept[:2]) == 2
    later = [
        replace(each, recorded_at=each.recorded_at + timedelta(days=1), recorded_by="Bob")
        for each in kept
    ]
    assert store.add(later) == 1
    assert store.add(kept) == 0
    assert list(store.outcomes())[:2] == kept[:2]
    assert store.add([replace(each, sequence=1) for each in kept]) == 3
    assert store.count() == 6


def test_other_values_of_a_recorded_outcome_are_refused(
    store: Store, outcomes: OutcomeMaker
) -> None:
    store.add(outcomes(2))
    changed = replace(outcomes(1)[0], time=EvaluatedQuantity(predicted=50.0, measured=56.0))
    with pytest.raises(OutcomeDiffers, match="an id of its own") as caught:
        store.add([*outcomes(1, run="new"), changed])
    assert (caught.value.column, caught.value.value) == ("time_measured_s", 56.0)
    assert list(store.outcomes()) == outcomes(2)


def test_programs_that_add_the_same_at_once_count_it_once(
    url: str, outcomes: OutcomeMaker
) -> None:
    programs = [started(url, outcomes(20)) for _ in range(2)]
    assert [ended(program) for program in programs] == [0, 0]
    for program in programs:
        assert program.stdout is not None
        program.stdout.close()
    with open_store(url) as store:
        assert list(store.outcomes()) == outcomes(20)


def test_no_statement_puts_another_outcome_in_the_place_of_one(
    store: Store, outcomes: OutcomeMaker
) -> None:
    """INSERT OR REPLACE of SQLite deletes what is in its way, and no trigger is told."""
    store.add(outcomes(1))
    names = ", ".join(each.name for each in outcome_table.columns if each.name != "id")
    word = "INSERT OR REPLACE" if store.place.file else "INSERT"
    end = "" if store.place.file else "ON CONFLICT DO NOTHING"
    with writing(store.engine, store.place) as connection:
        connection.execute(
            text(f"{word} INTO outcome ({names}) SELECT {names} FROM outcome {end}")
        )
    assert store.count() == 1


def test_a_store_of_an_earlier_version_keeps_what_it_counted_twice(
    sqlite_place: UrlMaker, outcomes: OutcomeMaker
) -> None:
    place = sqlite_place()
    with open_store(place) as store:
        store.add([*outcomes(2), *(replace(each, sequence=1) for each in outcomes(2))])
    with closing(sqlite3.connect(place)) as connection:
        connection.executescript(
            "DROP TRIGGER outcome_no_repeat; DROP INDEX outcome_identity;"
            "ALTER TABLE outcome DROP COLUMN sequence;"
            "UPDATE stepnc_kbe_version SET version_num = '0001';"
        )
    with open_store(place) as store:
        assert sorted(each.sequence for each in store.outcomes()) == [0, 0, 1, 1]
        assert store.add(outcomes(2)) == 0
        store.check()
