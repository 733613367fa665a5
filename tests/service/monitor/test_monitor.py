"""A monitor of our own agent, through our own client, over HTTP."""

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest

from service.monitor.freshness import Freshness
from service.monitor.monitor import COLUMNS, ConnectionState, MachineMonitor, MonitorSet
from service.monitor.source import MonitorSource
from service.requests.runs import SimulationRequest
from service.simulation.facts import rows
from service.simulation.run import RunFiles, simulate
from tests.service.agent.test_run import PARTS, run_of
from tests.service.monitor.played import PlayedAgent
from tests.service.waiting import until


@contextmanager
def monitoring(url: str, name: str = "paper003") -> Iterator[MachineMonitor]:
    monitor = MachineMonitor(MonitorSource(name=name, url=url))
    monitor.start()
    try:
        yield monitor
    finally:
        monitor.stop()
        assert not monitor._thread.is_alive()


def is_completed(monitor: MachineMonitor) -> bool:
    run = monitor.status().run
    return run is not None and not run.is_running


def test_time_and_energy_are_those_of_the_simulation() -> None:
    request, run = run_of("paper003_case1", "paper003", speed=0.0, rate_hz=100.0)
    with PlayedAgent(request, run) as agent, monitoring(agent.url) as monitor:
        until(lambda: is_completed(monitor))
        status, series = monitor.status(), monitor.series()
    truth = simulate(
        SimulationRequest(machine="paper003"), RunFiles(file=PARTS / "paper003_case1.stpnc")
    )
    assert status.run is not None
    assert status.run.begin == 0.0
    assert status.execution == "PROGRAM_COMPLETED"
    predicted = {row.id or "": row for row in rows(truth)}
    assert [step.id for step in status.run.steps] == list(predicted)
    for step in status.run.steps:
        total = predicted[step.id].total
        assert step.is_whole
        assert step.time == pytest.approx(total.duration, abs=0.03)
        assert step.energy == pytest.approx(total.energy.total, rel=2e-3)
        assert step.begin == pytest.approx(predicted[step.id].begin, abs=0.02)
    duration = sum(row.total.duration for row in predicted.values())
    assert series.columns == COLUMNS
    assert np.all(np.diff(series.values[:, 0]) > 0.0)
    assert series.values[-1, 0] == pytest.approx(duration, abs=0.05)
    assert status.latest["time_s"] == series.values[-1, 0]
    assert set(series.values[:, -1]) <= set(range(len(status.workingsteps) + 1))


def test_data_get_old_when_the_agent_is_ended_and_fresh_when_it_is_back(
    played: PlayedAgent,
) -> None:
    with monitoring(played.url) as monitor:
        until(lambda: monitor.status().freshness is Freshness.FRESH)
        before = monitor.count
        until(lambda: monitor.count > before + 5)
        played.stop()
        until(lambda: monitor.status().state is ConnectionState.LOST)
        status = monitor.status()
        assert status.freshness is Freshness.STALE
        assert status.problem
        assert status.latest
        until(lambda: (monitor.status().age or 0.0) > 1.0)
        before = monitor.count
        played.start()
        until(lambda: monitor.status().freshness is Freshness.FRESH)
        until(lambda: monitor.count > before + 5)
        assert monitor.status().problem == ""
        times = monitor.series().values[:, 0]
        assert np.all(np.diff(times) > 0.0)


def test_rows_begin_anew_when_the_clock_of_the_machine_jumps_back() -> None:
    request, run = run_of("paper003_case1", "paper003", speed=200.0, rate_hz=5.0)
    with PlayedAgent(request, run) as agent, monitoring(agent.url) as monitor:
        until(lambda: is_completed(monitor))
        origin = monitor.status().origin
        assert origin is not None
        agent.stop()
        agent.start()
        until(lambda: monitor.status().origin not in {None, origin})
        until(lambda: len(monitor.series()) > 5)
        assert np.all(np.diff(monitor.series().values[:, 0]) > 0.0)


def test_an_agent_that_is_not_there_is_awaited(played: PlayedAgent) -> None:
    played.stop()
    with monitoring(played.url) as monitor:
        until(lambda: monitor.status().problem)
        status = monitor.status()
        assert (status.state, status.age) == (ConnectionState.NEVER, None)
        assert status.freshness is Freshness.NONE
        assert (status.rows, status.latest, status.run) == (0, {}, None)
        played.start()
        until(lambda: monitor.status().state is ConnectionState.CONNECTED)


def test_rows_are_told_once(played: PlayedAgent) -> None:
    with monitoring(played.url) as monitor:
        until(lambda: monitor.count > 3)
        first, count = monitor.rows_since(0)
        until(lambda: monitor.count > count)
        more, _ = monitor.rows_since(count)
        assert first[-1, 0] < more[0, 0]


def test_a_set_starts_and_ends_all_its_monitors(played: PlayedAgent) -> None:
    source = MonitorSource(name="paper003", url=played.url)
    monitors = MonitorSet([source, MonitorSource(name="other", url="http://127.0.0.1:9")])
    monitors.start()
    until(lambda: monitors.by_name["paper003"].count)
    monitors.stop()
    assert not any(each._thread.is_alive() for each in monitors.by_name.values())
