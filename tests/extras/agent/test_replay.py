"""Recorded runs that are published again."""

import asyncio
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pyarrow import parquet

from extras.agent.model.agent import Agent
from extras.agent.model.buffer import ConditionValue, Value
from extras.agent.model.machine_model import machine_model
from extras.agent.model.model import DeviceModel, read_model
from extras.agent.model.shdr import written
from extras.agent.play import begun, play
from extras.agent.replay import RecordedRun, read_log
from extras.agent.requests import AgentRequest
from extras.agent.run import AgentFiles, replayed, simulated_with_document
from service.recording.run import record
from service.requests.runs import SimulationRequest
from service.simulation.run import RunFiles
from simulator.client.document_choices import DocumentChoice
from simulator.library import load_machine
from stepnc_model.errors import StepNcError
from tests.every_case import every_case
from tests.extras.agent.test_run import PARTS, run_of, served
from tests.service.recording.test_run import WHOLE

FOREIGN = Path(__file__).parents[4] / "shared" / "mtconnect" / "devices-mill.xml"


@pytest.fixture(scope="module")
def model() -> DeviceModel:
    return machine_model(load_machine("paper003")).model


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, model: DeviceModel) -> Path:
    """The same run in each form in which it may be recorded."""
    folder = tmp_path_factory.mktemp("runs")
    part = PARTS / "paper003_case1.stpnc"
    request = SimulationRequest(machine="paper003", rate_hz=10.0)
    for suffix in ("parquet", "csv"):
        simulated_with_document(
            request, RunFiles(file=part, output=folder / f"run.{suffix}"), folder / "run.xml",
            DocumentChoice(),
        )  # fmt: skip
    text = (folder / "run.csv").read_text(encoding="utf-8").replace('"', "")
    text = (
        text.replace(",", ";").replace(".", ",").replace("003_case1,stpnc", "003_case1.stpnc")
    )
    (folder / "other.csv").write_text(text, encoding="utf-8")
    agent = played(read(folder / "run.xml", model))
    lines = [
        line for item, time, value in held(agent) for line in written(model, item, time, value)
    ]
    (folder / "run.shdr").write_text("* PONG 1000\n" + "\n".join(lines), encoding="utf-8")
    return folder


def read(path: Path, model: DeviceModel) -> RecordedRun:
    return read_log(path, model, tell=lambda _: None)


def played(run: RecordedRun) -> Agent:
    async def work() -> Agent:
        agent = begun(run, speed=0.0, size=1 << 17)
        await play(agent, run, speed=0.0, is_looped=False)
        return agent

    return asyncio.run(work())


def held(agent: Agent) -> list[tuple[int, int, Value]]:
    """Data item, time and value of each observation."""
    span = np.arange(agent.buffer.first, agent.buffer.next)
    items, times = agent.buffer.take(span)
    values = [agent.buffer.value(each) for each in span.tolist()]
    return list(zip(items.tolist(), times.tolist(), values, strict=True))


def series(agent: Agent, id: str) -> tuple[np.ndarray, list[Any]]:
    item = agent.model.index[id]
    rows = [
        (time, value) for at, time, value in held(agent) if at == item and value is not None
    ]
    times = np.array([time for time, _ in rows])
    return (times - times[:1]) / 1e6, [value for _, value in rows]


@pytest.mark.parametrize("name", ["run.csv", "other.csv", "run.xml", "run.shdr"])
def test_each_form_of_a_run_tells_the_same(folder: Path, model: DeviceModel, name: str) -> None:
    whole, other = read(folder / "run.parquet", model), read(folder / name, model)
    assert other.duration == pytest.approx(whole.duration, abs=1e-5)
    expected, found = played(whole), played(other)
    for id in ("xpos", "xwatt", "cwatt", "feed", "cutforce", "speed"):
        times, values = series(expected, f"paper003_{id}")
        times_found, values_found = series(found, f"paper003_{id}")
        assert len(values) > 3, id
        ends = np.append(times, whole.duration)
        at = np.searchsorted(times_found, 0.5 * (ends[:-1] + ends[1:]), side="right") - 1
        assert np.allclose(np.array(values_found)[at], values, rtol=1e-4, atol=6e-3), id
    for id in ("exec", "line", "program"):
        words = [
            [str(each) for each in series(run, f"paper003_{id}")[1] if each != "READY"]
            for run in (found, expected)
        ]
        assert words[0] == words[1], id


def test_a_replayed_recording_is_recorded_as_it_was(tmp_path: Path) -> None:
    request, run = run_of("paper003_case1", "paper003", speed=0.0, rate_hz=10.0)
    first, second = tmp_path / "first.parquet", tmp_path / "second.parquet"
    with served(request, run) as url:
        record(f"{url}/paper003", first, WHOLE)
    again = read(first, run.devices)
    with served(request, again) as url:
        record(f"{url}/paper003", second, WHOLE)
    before, after = (parquet.read_table(each).to_pydict() for each in (first, second))
    assert len(before["time_s"]) == len(after["time_s"])
    for name in before:
        if isinstance(before[name][0], float):
            assert np.allclose(before[name], after[name], atol=1e-6, equal_nan=True), name
        else:
            assert before[name] == after[name], name


def test_a_log_of_another_machine_is_read_with_its_model(tmp_path: Path) -> None:
    if not FOREIGN.is_file():
        pytest.skip("devices-mill.xml is not in ../shared/mtconnect")
    model = read_model(FOREIGN)
    number, item = next(
        (at, each)
        for at, each in enumerate(model.items)
        if (each.category, each.representation) == ("SAMPLE", "VALUE")
    )
    condition = next(each for each in model.items if each.category == "CONDITION")
    log = tmp_path / "shop.log"
    log.write_text(
        f"2026-03-01T10:00:00.5Z|{item.id}|1.5|unknown|7\n"
        f"|{item.id}|2.5\n"
        f"2026-03-01T09:59:00Z|{item.id}|3.5\n"
        f"2026-03-01T10:00:02.5Z|{condition.id}|FAULT|E7|||spindle hot\n",
        encoding="utf-8",
    )
    run = read(log, model)
    assert run.duration == 2.0
    (feed,) = run.feeds()
    assert feed.items.tolist() == [number] * 3 + [model.index[condition.id]]
    assert feed.times.tolist() == [0.0, 0.0, 0.0, 2.0]
    expected = [item.scale * each + item.offset for each in (1.5, 2.5, 3.5)]
    assert feed.values[:3] == pytest.approx(expected)
    assert feed.values[3] == ConditionValue(level="FAULT", native_code="E7", text="spindle hot")


def test_what_the_model_does_not_have_is_told(tmp_path: Path, model: DeviceModel) -> None:
    file = tmp_path / "run.csv"
    file.write_text("time_s,x_axis_position_actual,smell\n0,1,2\n1,nan,3\n2,4,3\n")
    told: list[str] = []
    run = read_log(file, model, tell=told.append)
    assert told == [f"{file}: left out, as the device model has no such data item: smell"]
    (feed,) = run.feeds()
    assert (feed.times.tolist(), feed.values) == ([0.0, 1.0, 2.0], [1.0, None, 4.0])


@every_case(
    ("name", "text", "message"),
    [
        ("a.csv", "seconds,x\n1,2\n", "no column time_s"),
        (
            "a.csv",
            "time_s,smell\n1,2\n",
            r"nothing in it belongs .*\(smell\): name the machine",
        ),
        ("a.csv", "time_s,line\n", "no rows"),
        ("a.csv", "", "no column time_s"),
        ("a.csv", "time_s,x_axis_position_actual\n0,butter\n", "cannot be read: .*butter"),
        ("a.csv", b"\xff\xfe\x00", "cannot be read"),
        ("a.parquet", "PAR1", "cannot be read"),
        ("missing.parquet", None, "no such file"),
        ("missing.csv", None, "no such file"),
        ("missing.xml", None, "No such file"),
        ("missing.shdr", None, "No such file"),
        ("a.xml", "<MTConnectDevices/>", "MTConnectStreams"),
        ("a.xml", "<!DOCTYPE a [<!ENTITY b 'c'>]><a>&b;</a>", "document type"),
        (
            "a.xml",
            '<MTConnectStreams><a dataItemId="paper003_xpos" sequence="1" timestamp="now"/>'
            "</MTConnectStreams>",
            "timestamp 'now' is not in ISO 8601",
        ),
        (
            "a.xml",
            '<MTConnectStreams><a dataItemId="paper003_xpos" sequence="x" '
            'timestamp="2026-01-01T00:00:00Z">1</a></MTConnectStreams>',
            "invalid literal",
        ),
        (
            "a.xml",
            '<MTConnectStreams><a dataItemId="agent_avail" sequence="1" '
            'timestamp="2026-01-01T00:00:00Z">AVAILABLE</a></MTConnectStreams>',
            "nothing in it belongs",
        ),
        ("a.shdr", "no line of it\n", "nothing in it belongs .*the file is empty"),
        ("a.shdr", "2026-01-01T00:00:00Z|smell|7\n", r"belongs .*\(smell\)"),
    ],
)
def test_a_file_that_cannot_be_replayed_is_refused(
    tmp_path: Path, model: DeviceModel, name: str, text: str | bytes | None, message: str
) -> None:
    file = tmp_path / name
    if text is not None:
        file.write_bytes(text.encode() if isinstance(text, str) else text)
    with pytest.raises(StepNcError, match=message):
        read(file, model)


def test_a_time_before_the_last_is_refused_with_its_row(
    tmp_path: Path, model: DeviceModel
) -> None:
    file = tmp_path / "run.csv"
    file.write_text("time_s,line\n0,1\n2,2\n1,3\n")
    with pytest.raises(StepNcError, match="row 3: time 1 s: it must not be before 2 s"):
        read(file, model)


@every_case(
    ("words", "message"),
    [
        ({}, "name the machine with --machine, or its model with --device"),
        ({"machine": "vmc15", "adapters": ("a:1",)}, "exclude each other"),
        ({"machine": "vmc15", "is_looped": True, "speed": 2.0}, "at a speed of at most 1"),
    ],
)
def test_a_replay_that_cannot_be_is_refused(
    tmp_path: Path, words: dict[str, Any], message: str
) -> None:
    log = tmp_path / "run.csv"
    files = AgentFiles(run=RunFiles(file=log))
    with pytest.raises(StepNcError, match=message):
        replayed(AgentRequest(**words), files, log, tell=lambda _: None)
