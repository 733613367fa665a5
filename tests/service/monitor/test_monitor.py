"""A monitor of our own agent, through our own client, over HTTP."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
import pytest

from service.monitor.freshness import Freshness
from service.monitor.monitor import COLUMNS, ConnectionState, MachineMonitor, MonitorSet
from service.monitor.source import MonitorSource
from service.requests.runs import SimulationRequest
from service.simulation.facts import rows
from service.simulation.run import RunFiles, simulate
from tests.extras.agent.model.conftest import BEGIN, ServedAgent
from tests.extras.agent.test_run import PARTS, run_of
from tests.service.monitor.played import PlayedAgent
from tests.service.waiting import until

Serve = Callable[..., ServedAgent]
SECOND = 1_000_000
"""µs"""


@contextmanager
def monitoring(
    url: str, *, clock: Callable[[], float] = time.monotonic
) -> Iterator[MachineMonitor]:
    monitor = MachineMonitor(MonitorSource(name="machine", url=url), clock=clock)
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


def test_a_silent_machine_is_stale_while_it_runs_and_quiet_at_rest(serve: Serve) -> None:
    served, now = serve(), [0.0]
    served.add("vmc15_avail", ["AVAILABLE"])
    served.add("vmc15_exec", ["READY", "ACTIVE"])
    served.add("vmc15_xpos", [1.0, 2.0], begin=BEGIN + SECOND)
    with monitoring(f"{served.url}/vmc15", clock=lambda: now[0]) as monitor:
        until(lambda: monitor.status().latest.get("x_mm") == 2.0)
        assert monitor.status().freshness is Freshness.FRESH
        now[0] = 60.0
        status = monitor.status()
        assert (status.freshness, status.age) == (Freshness.STALE, 60.0)
        assert status.state is ConnectionState.CONNECTED
        served.add("vmc15_exec", ["PROGRAM_COMPLETED"], begin=BEGIN + 9 * SECOND)
        until(lambda: monitor.status().execution == "PROGRAM_COMPLETED")
        assert monitor.status().freshness is Freshness.FRESH
        now[0] = 120.0
        assert monitor.status().freshness is Freshness.QUIET
        run = monitor.status().run
        assert run is not None
        # From the word ACTIVE to the word PROGRAM_COMPLETED, between which rows came.
        assert sum(step.time for step in run.steps) == pytest.approx(8.9)


def test_a_machine_that_is_unavailable_says_so(serve: Serve) -> None:
    served = serve()
    served.add("vmc15_avail", ["AVAILABLE"])
    served.add("vmc15_exec", ["ACTIVE"])
    with monitoring(f"{served.url}/vmc15") as monitor:
        until(lambda: monitor.status().availability == "AVAILABLE")
        served.add("vmc15_avail", ["UNAVAILABLE"], begin=BEGIN + SECOND)
        until(lambda: monitor.status().availability == "UNAVAILABLE")
        assert monitor.status().state is ConnectionState.CONNECTED


def test_names_are_bounded(serve: Serve) -> None:
    served = serve()
    served.add("vmc15_workingstep", ["A" * 5000])
    served.add("vmc15_xpos", [1.0], begin=BEGIN + SECOND)
    with monitoring(f"{served.url}/vmc15") as monitor:
        until(lambda: monitor.count)
        assert monitor.status().workingstep == "A" * 200


def test_lost_observations_do_not_stop_a_monitor(serve: Serve) -> None:
    served = serve(size=1000)
    served.add("vmc15_xpos", [1.0])
    with monitoring(served.url) as monitor:
        until(lambda: monitor.count)
        for part in range(1, 4):
            begin = BEGIN + part * 1000 * SECOND
            served.add("vmc15_xpos", [float(n) for n in range(5000)], begin=begin)
        until(lambda: monitor.status().latest.get("x_mm") == 4999.0)
        assert monitor.status().state is ConnectionState.CONNECTED
