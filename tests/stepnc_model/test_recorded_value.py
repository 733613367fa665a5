"""What of numbers and times goes into a record, and what of a file is taken for one."""

from datetime import UTC, datetime
from math import inf, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.editing.outcome_record import (
    instant,
    known,
    measured_or_none,
    positive,
    positive_or_none,
    written,
)
from tests.every_case import every_case


@given(st.datetimes(timezones=st.timezones()))
def test_a_time_with_its_zone_comes_back(time: datetime) -> None:
    found = instant(written(time))
    assert found is not None
    assert found.replace(tzinfo=None) == time.replace(tzinfo=None)
    assert found.utcoffset() == time.utcoffset()


def test_a_time_without_zone_is_not_written_and_not_taken() -> None:
    with pytest.raises(ValueError, match="2026-03-01T00:00:00 has no time zone"):
        written(datetime(2026, 3, 1))
    assert instant("2026-03-01T00:00:00") is None
    assert instant("2026-03-01T00:00:00+00:00") == datetime(2026, 3, 1, tzinfo=UTC)


@pytest.mark.parametrize("text", [None, "", "yesterday", 7, "2026-13-01T00:00:00+00:00"])
def test_what_is_no_time_is_none(text: object) -> None:
    assert instant(text) is None


def test_numbers_have_twelve_digits() -> None:
    assert positive(1.0 / 3.0, "feed", "m/s") == 0.333333333333


@every_case("value", [0.0, -1.0, nan, inf])
def test_what_is_not_positive_is_refused(value: float) -> None:
    with pytest.raises(ValueError, match=f"invalid feed: {value:g} m/s"):
        positive_or_none(value, "feed", "m/s")


def test_nothing_measured_is_nothing_written() -> None:
    assert positive_or_none(None, "feed", "m/s") is None
    assert measured_or_none(None, "force", "N") is None


def test_a_force_may_be_nothing_at_all_but_not_less() -> None:
    assert measured_or_none(0.0, "force", "N") == 0.0
    with pytest.raises(ValueError, match="invalid force: -1 N"):
        measured_or_none(-1.0, "force", "N")


@every_case(
    ("value", "number"),
    [(1, 1.0), (0.5, 0.5), (nan, None), (inf, None), ("1", None), (None, None)],
)
def test_a_number_of_a_file_is_taken_where_it_is_one(
    value: object, number: float | None
) -> None:
    assert known(value) == number
