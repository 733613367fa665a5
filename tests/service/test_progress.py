"""Short work is silent; long work says how far it is."""

import time

import pytest

from service import progress
from service.progress import Progress, Ticker, bar


def test_short_work_is_silent() -> None:
    told: list[str] = []
    done = Progress(told.append, total=3)
    for _ in range(3):
        done()
    assert told == []


def test_long_work_says_how_far_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progress, "INTERVAL", 0.0)
    told: list[str] = []
    done = Progress(told.append, total=2)
    done()
    done()
    assert told == ["1 of 2 workingsteps", "2 of 2 workingsteps"]


def test_a_bar_is_as_full_as_its_share() -> None:
    assert bar(0.0) == "[--------------------]   0%"
    assert bar(0.52) == "[##########----------]  52%"
    assert bar(1.0) == "[####################] 100%"


def test_a_ticker_speaks_when_it_is_time(monkeypatch: pytest.MonkeyPatch) -> None:
    now = iter([0.0, 1.9, 2.0, 3.9, 4.0])
    monkeypatch.setattr(time, "monotonic", lambda: next(now))
    told: list[str] = []
    ticker = Ticker(told.append)
    for word in "abcd":
        ticker(lambda word=word: word)  # type: ignore[misc]
    assert told == ["b", "d"]
