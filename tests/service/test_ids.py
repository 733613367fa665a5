"""Ids sort by time, are never guessed, and are the only thing that becomes part of a path."""

import time
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.ids import LENGTH, LETTERS, is_id, new_id
from tests.every_case import every_case


def at(monkeypatch: pytest.MonkeyPatch, milliseconds: float) -> str:
    monkeypatch.setattr(time, "time_ns", lambda: int(milliseconds * 1_000_000))
    return new_id()


def test_an_id_is_one() -> None:
    id = new_id()
    assert is_id(id)
    assert len(id) == LENGTH
    assert set(id) <= set(LETTERS)


def test_ids_sort_by_the_millisecond_they_were_made_in(monkeypatch: pytest.MonkeyPatch) -> None:
    moments = [
        0,
        0.001,
        0.5,
        0.999,
        1,
        31,
        32,
        1 << 20,
        1_700_000_000_000,
        1_700_000_000_001,
        (1 << 48) - 1,
    ]
    made = [at(monkeypatch, moment) for moment in moments]
    assert all(one < other for one, other in pairwise(made))
    assert all(is_id(id) for id in made)


def test_ids_of_one_millisecond_are_different(monkeypatch: pytest.MonkeyPatch) -> None:
    made = {at(monkeypatch, 1_700_000_000_000) for _ in range(2000)}
    assert len(made) == 2000
    assert len({id[:9] for id in made}) == 1


@given(st.text(max_size=40))
def test_no_other_text_is_an_id(word: str) -> None:
    assert is_id(word) == (len(word) == LENGTH and set(word) <= set(LETTERS))


@every_case(
    "word",
    [
        "",
        "../../etc/passwd",
        f"{'0' * 26}\n",
        f"{'0' * 25}/",
        f"{'0' * 25}\0",
        "0" * 27,
        "İ" * 26,
    ],
)
def test_what_looks_like_one_is_none(word: str) -> None:
    assert not is_id(word)
