"""Runs that are kept, and served again."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from lxml import etree
from pyarrow import parquet

from extras.agent.model.agent import Agent
from extras.agent.model.buffer import AssetReference, ConditionValue, TimeSeriesValue, Value
from extras.agent.model.documents import timestamp
from extras.agent.model.model import DeviceModel, model_of
from extras.agent.play import begun
from extras.agent.runs import ROWS, RunKeeper, RunRepository
from stepnc_model.errors import StepNcError, WriteError
from tests.extras.agent.test_replay import held
from tests.extras.agent.test_run import run_of

BEGIN = 1_760_000_000_000_000
TYPES = (
    ("exec", "EVENT", "EXECUTION"), ("prog", "EVENT", "PROGRAM"), ("x", "SAMPLE", "POSITION"),
    ("step", "EVENT", "PROCESS_KIND_ID"), ("hot", "CONDITION", "TEMPERATURE"),
    ("vars", "EVENT", "VARIABLE"), ("shake", "SAMPLE", "ACCELERATION"),
    ("asset", "EVENT", "ASSET_CHANGED"),
)  # fmt: skip
REPRESENTED = {"vars": "DATA_SET", "shake": "TIME_SERIES"}


@pytest.fixture
def model() -> DeviceModel:
    """Two devices with the same data items."""
    devices = etree.Element("Devices")
    for name in ("m/1", "m2"):
        device = etree.SubElement(devices, "Device", id=name, uuid=f"u-{name}", name=name)
        holder = etree.SubElement(device, "DataItems")
        for id, category, kind in TYPES:
            words = {"category": category, "id": f"{name}.{id}", "type": kind}
            if id in REPRESENTED:
                words["representation"] = REPRESENTED[id]
            etree.SubElement(holder, "DataItem", words)
    return model_of(devices, "2.7")


@pytest.fixture
def agent(model: DeviceModel) -> Agent:
    return Agent(model=model, clock=lambda: BEGIN)


@pytest.fixture
def repository(tmp_path: Path) -> RunRepository:
    return RunRepository(tmp_path / "runs")


def add(agent: Agent, rows: Sequence[tuple[str, float, Value]]) -> None:
    items = np.array([agent.model.index[id] for id, _, _ in rows])
    times = np.array([BEGIN + round(1e6 * seconds) for _, seconds, _ in rows])
    agent.add(items, times, [value for *_, value in rows])


def found(agent: Agent) -> list[tuple[str, int, Value]]:
    rows = held(agent)[len(agent.model.items) :]
    return [(agent.model.items[item].id, time - BEGIN, value) for item, time, value in rows]


RUN: list[tuple[str, float, Value]] = [
    ("m2.x", 0.5, 7.0),
    ("m/1.prog", 0.5, "part.stpnc"),
    ("m/1.x", 0.5, 1.5),
    ("m/1.exec", 1.0, "ACTIVE"),
    ("m/1.step", 1.0, "WS 1"),
    ("m/1.x", 2.0, None),
    ("m2.x", 2.0, 8.0),
    ("m/1.hot", 2.0, ConditionValue(level="FAULT", native_code="E7", text="hot")),
    ("m/1.vars", 2.5, {"a": "1", "b": None}),
    ("m/1.shake", 2.5, TimeSeriesValue(values=(0.5, 1.0), rate=100.0)),
    ("m/1.asset", 2.5, AssetReference(id="T1", type="CuttingTool")),
    ("m/1.step", 3.0, "WS 2"),
    ("m/1.x", 3.5, 4),
    ("m/1.exec", 4.0, "PROGRAM_COMPLETED"),
    ("m/1.x", 5.0, 9.0),
]


def test_a_run_is_kept_as_it_was(agent: Agent, repository: RunRepository) -> None:
    RunKeeper(agent, repository)
    add(agent, RUN[:2])
    add(agent, RUN[2:])
    (run,) = repository.runs()
    assert (run.machine, run.part, run.is_completed) == ("m/1", "part.stpnc", True)
    assert (run.begin, run.end) == (timestamp(BEGIN + 1_000_000), timestamp(BEGIN + 4_000_000))
    again = repository.load(run.id)
    told = found(again)
    # What held at the beginning comes first, with the time of the beginning.
    assert sorted(told[:2]) == [
        ("m/1.prog", 1_000_000, "part.stpnc"),
        ("m/1.x", 1_000_000, 1.5),
    ]
    own = [row for row in RUN[3:14] if row[0].startswith("m/1")]
    assert told[2:] == [(id, round(1e6 * time), value) for id, time, value in own]
    assert len(told) == run.observations
    first, second = run.workingsteps
    assert (first.id, second.id) == ("WS 1", "WS 2")
    assert again.buffer.value(first.first) == "WS 1"
    assert again.buffer.value(second.first) == "WS 2"
    assert second.first == first.last + 1


def test_a_run_that_is_broken_off_is_kept_as_such(
    agent: Agent, repository: RunRepository
) -> None:
    keeper = RunKeeper(agent, repository)
    add(agent, RUN[:9])
    assert repository.runs() == []
    keeper.close()
    (run,) = repository.runs()
    assert not run.is_completed
    assert [step.id for step in run.workingsteps] == ["WS 1"]


def test_devices_have_runs_of_their_own(agent: Agent, repository: RunRepository) -> None:
    keeper = RunKeeper(agent, repository)
    add(agent, [("m2.exec", 0.1, "ACTIVE"), *RUN, ("m2.exec", 6.0, "STOPPED")])
    keeper.close()
    runs = {run.machine: run for run in repository.runs()}
    assert set(runs) == {"m/1", "m2"}
    assert not runs["m2"].is_completed
    assert [id for id, *_ in found(repository.load(runs["m2"].id))] == [
        "m2.exec", "m2.x", "m2.x", "m2.exec",
    ]  # fmt: skip


def test_long_runs_are_written_in_groups(agent: Agent, repository: RunRepository) -> None:
    keeper = RunKeeper(agent, repository)
    many = [("m2.x", 1.0 + 0.001 * row, float(row)) for row in range(2 * ROWS)]
    add(agent, [("m2.exec", 0.1, "ACTIVE"), *many, ("m2.exec", 99.0, "PROGRAM_COMPLETED")])
    keeper.close()
    (run,) = repository.runs()
    file = repository.folder / f"{run.id}.parquet"
    assert parquet.read_metadata(file).num_row_groups == 3
    assert [value for *_, value in found(repository.load(run.id))][1:-1] == [
        value for *_, value in many
    ]


def test_a_simulated_run_is_served_like_its_own_agent(repository: RunRepository) -> None:
    request, run = run_of("paper003_case1", "paper003", speed=0.0, rate_hz=10.0)
    agent = begun(run, speed=0.0, size=request.buffer)
    keeper = RunKeeper(agent, repository)
    agent.tell(run.first(0), time=agent.buffer.last_time)
    stamps = agent.buffer.last_time + (run.feed.times * 1e6).astype(int)
    agent.add(run.feed.items, stamps, run.feed.values)
    keeper.close()
    (kept,) = repository.runs()
    assert kept.part == "paper003_case1.stpnc"
    again = repository.load(kept.id)
    for item, entries in enumerate(agent.buffer.state):
        if agent.model.items[item].type in {"AVAILABILITY", "ASSET_CHANGED", "PART_COUNT"}:
            continue
        if not agent.model.items[item].id.startswith("agent"):
            assert [each.value for each in entries] == [
                each.value for each in again.buffer.state[item]
            ], agent.model.items[item].id


def test_a_disk_that_refuses_stops_nothing(agent: Agent, repository: RunRepository) -> None:
    told: list[str] = []
    RunKeeper(agent, repository, tell=told.append)
    repository.folder.rmdir()
    add(agent, RUN)
    assert agent.buffer.last == len(agent.model.items) + len(RUN)
    assert len(told) == 1
    assert told[0].startswith("a run is not kept: ")


def test_files_that_are_no_runs_are_left_out(repository: RunRepository) -> None:
    (repository.folder / "a.parquet").write_bytes(b"PAR1")
    assert repository.runs() == []
    assert repository.run("a") is None
    assert repository.run("../a") is None
    with pytest.raises(StepNcError, match="cannot be read"):
        repository.load("a")


def test_a_folder_that_cannot_be_made_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(WriteError, match="file"):
        RunRepository(tmp_path / "file" / "runs")
