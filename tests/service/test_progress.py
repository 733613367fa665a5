"""Short work is silent; long work says how far it is."""

import pytest

from service import progress
from service.progress import Progress


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
