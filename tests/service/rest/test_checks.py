"""Checks: two at a time, none twice, answers within a bound of bytes."""

import asyncio
from contextlib import ExitStack
from threading import Lock, Semaphore

import pytest

from service.errors import Unavailable
from service.rest import checks
from service.rest.checks import MOST_AT_ONCE, CheckCache, in_turn


def test_few_are_made_at_once() -> None:
    lock, full = Lock(), Semaphore(0)
    now, most = 0, 0

    def read() -> None:
        nonlocal now, most
        with lock:
            now += 1
            most = max(most, now)
            if now == MOST_AT_ONCE:
                full.release()
        # The first waits for the second: both are at work.
        assert full.acquire(timeout=120.0)
        full.release()
        with lock:
            now -= 1

    async def all_at_once() -> None:
        await asyncio.gather(*(in_turn(read) for _ in range(6)))

    asyncio.run(all_at_once())
    assert most == MOST_AT_ONCE


def test_an_answer_is_made_once() -> None:
    made: list[int] = []

    def make() -> bytes:
        made.append(1)
        return b"answer"

    async def asked() -> None:
        answers = CheckCache()
        for _ in range(3):
            assert await answers.get("a", make) == b"answer"

    asyncio.run(asked())
    assert made == [1]


def test_an_error_is_not_kept() -> None:
    def fail() -> bytes:
        raise ValueError("no")

    async def asked() -> None:
        answers = CheckCache()
        with pytest.raises(ValueError, match="no"):
            await answers.get("a", fail)
        assert await answers.get("a", lambda: b"yes") == b"yes"

    asyncio.run(asked())


def test_those_asked_for_last_stay_within_the_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(checks, "MOST_BYTES", 10)
    answers = CheckCache()

    async def asked() -> None:
        for name in "abc":
            await answers.get(name, lambda: b"1234")
        assert list(answers._kept) == ["b", "c"]
        await answers.get("b", lambda: b"other")
        await answers.get("d", lambda: b"1234")
        assert dict(answers._kept) == {"b": b"1234", "d": b"1234"}
        assert await answers.get("e", lambda: b"x" * 11) == b"x" * 11
        assert not answers._kept
        assert answers._size == 0

    asyncio.run(asked())


def test_readings_that_hang_hold_no_more_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(checks, "READING_WAIT", 0.01)
    with ExitStack() as hanging:
        for _ in range(2):
            hanging.enter_context(checks.reading_in_turn())
        with pytest.raises(Unavailable, match="still being read"), checks.reading_in_turn():
            pass
    with checks.reading_in_turn():
        """One of them may go on."""
