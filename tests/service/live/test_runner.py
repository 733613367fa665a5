"""The helm of a run: paced by a clock that the test turns, deaf to nothing, never stopped."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from controller.orders import EventKind, LoopEvent
from service.errors import StorageFull
from service.live import runner as live_runner
from service.live import series
from service.live.journal import LiveFolder, append, read_on
from service.live.playback import TICK
from service.live.runner import (
    AT_ONCE,
    COLUMNS,
    FORGOTTEN,
    FULL,
    REFUSED,
    LiveRunner,
    RunUpdate,
)
from service.live.series import open_series
from stepnc_model.errors import StepNcError
from tests.service.live.test_playback import Clock
from tests.service.live.test_rows import MOMENT


class Run:
    """A run of so many seconds with a row each tick."""

    def __init__(self, seconds: float) -> None:
        self.time = 0.0
        self.is_waiting = False
        self.obeyed: list[Mapping[str, Any]] = []
        self._seconds = seconds
        self._events: list[LoopEvent] = []
        self._rows = 0

    def advance(self, until: float) -> bool:
        self.time = until
        self._rows += 1
        return until < self._seconds

    def taken(self) -> RunUpdate:
        moments = (MOMENT._replace(time=self.time),) * self._rows
        events, self._rows, self._events = tuple(self._events), 0, []
        return RunUpdate(moments=moments, events=events)

    def obey(self, order: Mapping[str, Any]) -> None:
        if "bad" in order:
            raise StepNcError("bad is beyond its bounds")
        self.obeyed.append(order)
        self._events.append(LoopEvent(time=self.time, kind=EventKind.ORDER, text=str(order)))
        if "end" in order:
            self._seconds, self.is_waiting = 0.0, False

    def snapshot(self) -> dict[str, Any]:
        return {"time_s": self.time}


@pytest.fixture
def folder(tmp_path: Path) -> LiveFolder:
    return LiveFolder(path=tmp_path)


def go(folder: LiveFolder, run: Run, *, pace: float, **more: Any) -> Clock:
    clock = Clock()
    LiveRunner(run=run, folder=folder, pace=pace, now=clock.now, wait=clock.wait, **more).go()
    return clock


@pytest.mark.parametrize("pace", [0.5, 1.0, 10.0])
def test_the_machines_time_passes_by_the_pace(folder: LiveFolder, pace: float) -> None:
    run = Run(seconds=10.0)
    clock = go(folder, run, pace=pace)
    assert (clock.time - 100.0) * pace == pytest.approx(run.time, rel=1e-9)
    assert run.time == pytest.approx(10.0, abs=2.0 * TICK * pace)


def test_without_a_pace_nobody_waits(folder: LiveFolder) -> None:
    run = Run(seconds=100.0)
    clock = go(folder, run, pace=0.0)
    assert clock.waits == []
    assert run.time == pytest.approx(100.0, abs=AT_ONCE)


def test_rows_and_the_status_are_there_for_others(folder: LiveFolder) -> None:
    heard: list[dict[str, Any]] = []
    run = Run(seconds=1.0)
    go(folder, run, pace=1.0, tell=heard.append)
    rows = open_series(folder.series)
    assert rows is not None
    assert len(rows) == len(heard)
    status = folder.read_status()
    assert status is not None
    assert (status["time_s"], status["pace"]) == (run.time, 1.0)
    assert heard[-1] == status


def test_orders_are_obeyed_once_in_their_order_and_told(folder: LiveFolder) -> None:
    for order in ({"a": 1}, {"b": 2, "pace": 5.0}, {"a": 3}):
        append(folder.orders, order)
    run = Run(seconds=1.0)
    go(folder, run, pace=1.0)
    assert run.obeyed == [{"a": 1}, {"b": 2}, {"a": 3}]
    told = read_on(folder.events, 0).lines
    assert [line["kind"] for line in told] == [EventKind.ORDER.value] * 3
    status = folder.read_status()
    assert status is not None
    assert status["pace"] == 5.0


def test_an_order_that_is_refused_is_told_and_the_run_goes_on(folder: LiveFolder) -> None:
    append(folder.orders, {"bad": 1})
    append(folder.orders, {"a": 2})
    run = Run(seconds=1.0)
    go(folder, run, pace=1.0)
    assert run.obeyed == [{"a": 2}]
    told = [line for line in read_on(folder.events, 0).lines if line["kind"] == REFUSED]
    assert [line["text"] for line in told] == ["bad is beyond its bounds"]


def test_an_order_that_was_cut_off_is_passed_over(folder: LiveFolder) -> None:
    folder.orders.write_bytes(b'{"a": \n{"a": 2}\n')
    run = Run(seconds=1.0)
    go(folder, run, pace=1.0)
    assert run.obeyed == [{"a": 2}]


def test_a_run_that_waits_is_waited_for_until_somebody_ends_it(folder: LiveFolder) -> None:
    run = Run(seconds=0.0)
    run.is_waiting = True
    ticks = 0

    def tell(_: dict[str, Any]) -> None:
        nonlocal ticks
        ticks += 1
        if ticks == 20:
            append(folder.orders, {"end": True})

    clock = go(folder, run, pace=0.0, tell=tell)
    assert ticks == 21
    # Without a pace too: it stands, and nobody turns in circles.
    assert len(clock.waits) == 20


def test_a_run_that_waits_and_for_which_nobody_comes_ends_and_says_so(
    folder: LiveFolder,
) -> None:
    run = Run(seconds=0.0)
    run.is_waiting = True
    ticks = 0

    def tell(_: dict[str, Any]) -> None:
        nonlocal ticks
        ticks += 1
        if ticks == 10:
            append(folder.orders, {"bad": 1})

    clock = go(folder, run, pace=1.0, tell=tell, patience=1.0)
    # Who asks for something is there, also when it cannot be done.
    assert clock.time - 100.0 == pytest.approx(10 * TICK + 1.0, abs=2.0 * TICK)
    kinds = [line["kind"] for line in read_on(folder.events, 0).lines]
    assert kinds == [REFUSED, FORGOTTEN]


def test_a_run_that_goes_on_is_not_forgotten(folder: LiveFolder) -> None:
    run = Run(seconds=10.0)
    go(folder, run, pace=1.0, patience=0.5)
    assert run.time == pytest.approx(10.0, abs=2.0 * TICK)
    assert not folder.events.exists()


def test_a_series_that_is_full_is_told_once_and_the_run_goes_on(
    folder: LiveFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(series, "MOST_BYTES", 5 * len(COLUMNS) * series.BYTES)
    run = Run(seconds=1.0)
    go(folder, run, pace=1.0)
    assert run.time == pytest.approx(1.0, abs=2.0 * TICK)
    kept, status = open_series(folder.series), folder.read_status()
    assert kept is not None
    assert status is not None
    assert (len(kept), status["is_series_full"]) == (5, True)
    assert [line["kind"] for line in read_on(folder.events, 0).lines] == [FULL]


def test_a_run_of_more_rows_than_can_be_kept_is_refused(
    folder: LiveFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(live_runner, "MOST_ROWS", 5)
    with pytest.raises(StepNcError, match="exceeds 5 rows"):
        go(folder, Run(seconds=1.0), pace=1.0)


def test_a_run_that_cannot_tell_how_it_is_ends_with_the_reason(folder: LiveFolder) -> None:
    (folder.path / ".status.json").symlink_to("/dev/full")
    with pytest.raises(StorageFull):
        go(folder, Run(seconds=1.0), pace=1.0)
