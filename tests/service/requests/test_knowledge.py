"""Words that say which outcomes are meant."""

import argparse
from collections.abc import Callable
from datetime import UTC, datetime, timedelta

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.requests.fields import add_options, from_options, text
from service.requests.knowledge import SelectionRequest, end, moment
from service.verbs.kbe.review.request import share
from stepnc_model.errors import StepNcError
from tests.every_case import every_case


def request(*words: str) -> SelectionRequest:
    parser = argparse.ArgumentParser()
    add_options(parser, SelectionRequest)
    return from_options(SelectionRequest, parser.parse_args(words))


def test_filters_become_a_selection() -> None:
    words = ["--machine", "vmc15", "--material", "C45", "--tool", "T 1", "--run", "r7"]
    words += ["--feature-kind", "slot", "--program", "p.stpnc"]
    words += ["--since", "2026-03-05T12:00+01:00", "--until", "2026-03-05T12:00Z"]
    found = request(*words).selection
    assert (found.machine, found.material, found.tool) == ("vmc15", "C45", "T 1")
    assert (found.feature_kind, found.program, found.run) == ("slot", "p.stpnc", "r7")
    assert found.since == datetime(2026, 3, 5, 11, 0, tzinfo=UTC)
    assert found.until == datetime(2026, 3, 5, 12, 0, tzinfo=UTC)


def test_no_filter_means_everything() -> None:
    found = request().selection
    assert {found.machine, found.run, found.since, found.until} == {None}


def test_an_end_before_the_beginning_is_refused() -> None:
    with pytest.raises(StepNcError, match="is not before until"):
        _ = request("--since", "2026-03-06", "--until", "2026-03-05").selection


@given(st.dates(min_value=datetime(1980, 1, 1).date(), max_value=datetime(2099, 1, 1).date()))
def test_a_day_counts_from_its_beginning_to_its_end(day: object) -> None:
    begin, finish = moment(str(day)), end(str(day))
    assert (begin.hour, finish.hour) == (0, 0)
    assert finish.date() - begin.date() == timedelta(days=1)
    assert begin.tzinfo is not None
    assert finish.tzinfo is not None


@given(st.datetimes(timezones=st.timezones()))
def test_a_time_with_a_zone_is_that_time(when: datetime) -> None:
    word = when.isoformat()
    try:
        found = moment(word)
    except StepNcError:
        # Before the year 1 or after 9999 here, or an offset with seconds from long ago.
        return
    assert found == datetime.fromisoformat(word)


@every_case("word", ["", "yesterday", "2026-13-01", "5.3.2026", "2026-02-30"])
@every_case("read", [moment, end])
def test_what_is_no_time_is_refused(read: Callable[[str], datetime], word: str) -> None:
    with pytest.raises(StepNcError, match="is not a time"):
        read(word)


def test_the_last_day_of_all_has_no_end() -> None:
    with pytest.raises(StepNcError, match="is not a supported time"):
        end("9999-12-31")


@pytest.mark.parametrize(
    ("word", "value"), [("0.25", 0.25), ("25%", 0.25), ("0", 0.0), ("100%", 1.0)]
)
def test_a_share_may_be_in_per_cent(word: str, value: float) -> None:
    assert share(word) == pytest.approx(value, rel=1e-15)


@every_case("word", ["", "%", "one"])
def test_what_is_no_share_is_refused(word: str) -> None:
    with pytest.raises(StepNcError, match="is not a share"):
        share(word)


def test_bytes_that_are_no_text_are_refused() -> None:
    assert text("Fräser Ø18") == "Fräser Ø18"
    with pytest.raises(argparse.ArgumentTypeError, match="is not valid text"):
        text("\udcff")
