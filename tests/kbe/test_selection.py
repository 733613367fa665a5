"""Which outcomes are meant: the database agrees with Python."""

from collections.abc import Iterator
from dataclasses import replace
from datetime import datetime, timedelta
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kbe.queries import Selection, conditions
from kbe.store import Store, open_store
from stepnc_model.outcome import Context, ProcessOutcome

WORDS = ("a", "b")


def varied(outcome: ProcessOutcome) -> list[ProcessOutcome]:
    """All combinations of two values in each attribute that can be selected."""
    return [
        replace(
            outcome,
            context=Context(machine=machine, material=material, tool=tool),
            feature=replace(outcome.feature, kind=kind),
            program=program,
            run=run,
            recorded_at=outcome.recorded_at + timedelta(hours=index % 7),
            sequence=index,
        )
        for index, (machine, material, tool, kind, program, run) in enumerate(
            product(WORDS, repeat=6)
        )
    ]


@pytest.fixture(scope="module")
def filled(
    tmp_path_factory: pytest.TempPathFactory, outcome: ProcessOutcome
) -> Iterator[Store]:
    with open_store(str(tmp_path_factory.mktemp("selection") / "kbe.db")) as store:
        store.add(varied(outcome))
        yield store


def is_meant(selection: Selection, outcome: ProcessOutcome) -> bool:
    """The same rule, written apart."""
    pairs = [
        (selection.machine, outcome.context.machine),
        (selection.material, outcome.context.material),
        (selection.tool, outcome.context.tool),
        (selection.feature_kind, outcome.feature.kind),
        (selection.program, outcome.program),
        (selection.run, outcome.run),
    ]
    if any(wanted not in {None, found} for wanted, found in pairs):
        return False
    if selection.since is not None and outcome.recorded_at < selection.since:
        return False
    return selection.until is None or outcome.recorded_at < selection.until


words = st.none() | st.sampled_from([*WORDS, "c"])
NOON = datetime.fromisoformat("2026-03-05T12:00:00+00:00")
times = st.none() | st.integers(-1, 8).map(lambda hours: NOON + timedelta(hours=hours))


@given(
    selection=st.builds(
        Selection,
        machine=words,
        material=words,
        tool=words,
        feature_kind=words,
        program=words,
        run=words,
        since=times,
        until=times,
    )
)
def test_selected_are_those_that_have_all_of_it(filled: Store, selection: Selection) -> None:
    everything = list(filled.outcomes())
    wanted = [outcome for outcome in everything if is_meant(selection, outcome)]
    assert list(filled.outcomes(selection)) == wanted
    assert filled.count(selection) == len(wanted)
    assert sum(group.outcomes for group in filled.groups(selection)) == len(wanted)


def test_time_without_zone_is_refused() -> None:
    with pytest.raises(ValueError, match="since"):
        conditions(Selection(since=datetime(2026, 1, 1)))
    with pytest.raises(ValueError, match="until"):
        conditions(Selection(until=datetime(2026, 1, 1)))
