"""A run as its agent publishes it, over real HTTP."""

import asyncio
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
import uvicorn
from lxml import etree

from extras.agent.model.http import application
from extras.agent.play import PlayableRun, begun, now, play
from extras.agent.requests import AgentRequest
from extras.agent.run import (
    AgentFiles,
    PublishedRun,
    adapted,
    listening,
    published,
    published_run,
    simulated_with_document,
)
from service.requests.runs import SimulationRequest
from service.simulation.run import RunFiles, simulate
from simulator.client.document_choices import DocumentChoice, NameSet, SchemaVersion
from stepnc_model.errors import StepNcError
from stepnc_model.programs.program import Program
from tests.extras.agent.model.conftest import header, local, observations, require_valid
from tests.extras.agent.model.test_model import TYPES

PARTS = Path(__file__).parents[3] / "examples" / "parts"


def silent(_: str) -> None:
    """Tell nobody."""


def run_of(part: str, machine: str, **words: Any) -> tuple[AgentRequest, PublishedRun]:
    request = AgentRequest(machine=machine, **words)
    return request, published_run(request, RunFiles(file=PARTS / f"{part}.stpnc"))


@contextmanager
def served(request: AgentRequest, run: PlayableRun) -> Iterator[str]:
    """Address of the agent of a run that is played while it is served."""
    listener = listening("127.0.0.1", 0)
    server: list[uvicorn.Server] = []

    async def work() -> None:
        agent = begun(run, speed=request.speed, size=request.buffer)
        config = uvicorn.Config(
            application(agent), log_config=None, lifespan="off", ws="none",
            timeout_graceful_shutdown=1,
        )  # fmt: skip
        server.append(uvicorn.Server(config))
        player = asyncio.create_task(
            play(agent, run, speed=request.speed, is_looped=request.is_looped)
        )
        await server[0].serve(sockets=[listener])
        player.cancel()

    thread = threading.Thread(target=asyncio.run, args=(work(),))
    thread.start()
    host, port = listener.getsockname()
    url = f"http://{host}:{port}"
    try:
        httpx.get(url, timeout=120.0)
        yield url
    finally:
        server[0].should_exit = True
        thread.join(120.0)


def all_samples(url: str) -> list[Any]:
    """All observations, paged, until the program is over."""
    at, seen = 1, []
    while True:
        root = etree.fromstring(
            httpx.get(f"{url}/sample?from={at}&count=5000", timeout=120.0).content
        )
        found = observations(root)
        seen += found
        at = int(header(root)["nextSequence"])
        if not found and any(each.text == "PROGRAM_COMPLETED" for each in seen):
            return seen


def series(seen: list[Any], id: str) -> tuple[np.ndarray, np.ndarray]:
    """Times in s and values of a data item; each value holds until the next."""
    rows = [
        each for each in seen if each.get("dataItemId") == id and each.text != "UNAVAILABLE"
    ]
    times = np.array([np.datetime64(each.get("timestamp")[:-1], "us") for each in rows])
    return times.astype("int64") / 1e6, np.array([float(each.text) for each in rows])


@pytest.mark.parametrize(
    ("part", "machine"), [("paper003_case1", "paper003"), ("paper000", "paper000")]
)
def test_a_client_finds_energy_and_time_of_the_simulation(part: str, machine: str) -> None:
    request, run = run_of(part, machine, rate_hz=100.0, speed=0.0)
    with served(request, run) as url:
        seen = all_samples(url)
    energy = 0.0
    end = max(float(series(seen, f"{machine}_run_time")[0][-1]), 0.0)
    for each in run.model.model.items:
        if each.type == "WATTAGE" and each.name != "watt":
            times, watts = series(seen, each.id)
            energy += float(np.sum(watts * np.diff(times, append=end)))
    _, told = series(seen, f"{machine}_energy")
    _, seconds = series(seen, f"{machine}_run_time")
    simulation = simulate(
        SimulationRequest(machine=machine), RunFiles(file=PARTS / f"{part}.stpnc")
    )
    assert energy == pytest.approx(simulation.whole.energy.total, rel=5e-4)
    assert told[-1] == pytest.approx(simulation.whole.energy.total, rel=5e-4)
    assert seconds[-1] == pytest.approx(run.feed.duration, abs=0.01)
    states = [each.text for each in seen if each.get("dataItemId") == f"{machine}_exec"]
    assert states[-1] == "PROGRAM_COMPLETED"
    assert "ACTIVE" in states


def test_the_running_workingstep_and_its_tool_are_told() -> None:
    request, run = run_of("bracket", "vmc15", material="c45", speed=0.0, rate_hz=1.0)
    with served(request, run) as url:
        assets = require_valid(httpx.get(f"{url}/assets?count=50").content, "2.7")
        seen = all_samples(url)
        stamps = [each.get("timestamp") for each in seen]
        assert stamps == sorted(stamps)
        last = np.datetime64(stamps[-1][:-1], "us").astype("int64")
        assert last <= now()
    ids = [each.get("assetId") for each in assets.iter() if each.get("assetId")]
    used = {each.text for each in seen if each.get("dataItemId") == "vmc15_tool_asset"}
    assert used - {"UNAVAILABLE"} <= set(ids)
    assert len(ids) == len(run.tools) > 3
    (first,) = (each for each in assets.iter() if each.get("assetId") == "vmc15.T1")
    assert first.get("toolId") == run.tools[0].id.replace(" ", "_")
    steps = [each.text for each in seen if each.get("dataItemId") == "vmc15_workingstep"]
    program = Program.load(PARTS / "bracket.stpnc")
    ids = [step.id for step in program.workingsteps]
    assert [each for each in steps if each != "UNAVAILABLE"] == ids


def test_time_is_scaled_and_stamps_never_pass_the_clock() -> None:
    request, run = run_of("paper000", "paper000", speed=20.0)
    with served(request, run) as url:
        begin = now()
        seen = all_samples(url)
        took = (now() - begin) / 1e6
    assert took > 0.8 * run.feed.duration / 20.0
    stamps = [
        np.datetime64(each.get("timestamp")[:-1], "us").astype("int64") / 1e6
        for each in seen
        if each.get("dataItemId") == "paper000_run_time" and each.text != "UNAVAILABLE"
    ]
    gaps = [round(late - early, 3) for early, late in pairwise(stamps)]
    assert set(gaps) <= {0.05, 0.1, 0.15} or max(gaps) < 0.2


def test_a_loop_runs_in_real_time_only() -> None:
    with pytest.raises(StepNcError, match="--loop: only at a speed of at most 1"):
        run_of("paper000", "paper000", speed=2.0, is_looped=True)


def test_a_port_that_is_taken_is_told() -> None:
    taken = listening("127.0.0.1", 0)
    port = taken.getsockname()[1]
    with pytest.raises(StepNcError, match=f"port {port}: Address already in use"):
        listening("127.0.0.1", port)
    taken.close()


def test_a_model_needs_adapters_and_no_program(tmp_path: Path) -> None:
    device = tmp_path / "model.xml"
    device.write_text(
        '<MTConnectDevices xmlns="urn:mtconnect.org:MTConnectDevices:2.7">'
        f"{TYPES}</MTConnectDevices>",
        encoding="utf-8",
    )
    with pytest.raises(StepNcError, match="name its adapters"):
        adapted(AgentRequest(), AgentFiles(run=RunFiles(), device=device), tell=silent)
    program = RunFiles(file=PARTS / "paper000.stpnc")
    with pytest.raises(StepNcError, match="name no program"):
        adapted(AgentRequest(), AgentFiles(run=program, device=device), tell=silent)
    with pytest.raises(StepNcError, match="name the device model"):
        published(AgentRequest(adapters=("a:1",)), program, tell=silent)
    for address in ("shop", "shop:0", ":7878", "shop:http"):
        request = AgentRequest(adapters=(address,))
        with pytest.raises(StepNcError, match="expected HOST:PORT"):
            adapted(request, AgentFiles(run=RunFiles(), device=device), tell=silent)
    agent, work = adapted(
        AgentRequest(adapters=("127.0.0.1:7878", "[::1]:7879")),
        AgentFiles(run=RunFiles(), device=device),
        tell=silent,
    )
    assert len(work) == 2
    assert [local(each) for each in agent.model.root] == ["Device"]


@pytest.mark.parametrize("version", list(SchemaVersion))
def test_a_simulated_run_is_written_as_a_document(
    version: SchemaVersion, tmp_path: Path
) -> None:
    output = tmp_path / "run.xml"
    request = SimulationRequest(machine="paper003", rate_hz=10.0)
    files = RunFiles(file=PARTS / "paper003_case1.stpnc")
    simulation = simulated_with_document(
        request, files, output, DocumentChoice(version=version, names=NameSet.PAPERS)
    )
    seen = observations(require_valid(output.read_bytes(), version.value))
    assert [int(each.get("sequence")) for each in seen] == list(range(1, len(seen) + 1))
    energy = 0.0
    end = max(series(seen, "paper003_run_time")[0])
    ids = {each.get("dataItemId") for each in seen if local(each) == "Wattage"}
    for id in ids:
        times, watts = series(seen, id)
        energy += float(np.sum(watts * np.diff(times, append=end)))
    # At 10 samples a second; at 100 it is within 0.01 %.
    assert energy == pytest.approx(simulation.whole.energy.total, rel=5e-3)


def test_a_document_in_a_folder_is_named_by_machine_and_part(tmp_path: Path) -> None:
    request = SimulationRequest(machine="paper003", rate_hz=1.0)
    files = RunFiles(file=PARTS / "paper003_case1.stpnc")
    for shown in (DocumentChoice(), DocumentChoice(part="0-1", batch="0")):
        simulated_with_document(request, files, tmp_path, shown)
    names = sorted(each.name for each in tmp_path.iterdir())
    assert names == ["paper003_0-1.xml", "paper003_paper003_case1.xml"]
    seen = observations(require_valid((tmp_path / names[0]).read_bytes(), "2.7"))
    told = {each.get("dataItemId"): each.text for each in seen}
    assert (told["paper003_part"], told["paper003_batch"]) == ("0-1", "0")


def test_the_parts_of_a_batch_are_numbered() -> None:
    _, run = run_of("paper003_case1", "paper003", rate_hz=1.0, batch="7")
    parts = [run.first(count)["paper003_part"] for count in range(2)]
    assert parts == ["7-0", "7-1"]
    assert run.first(0)["paper003_batch"] == "7"


def test_a_document_never_replaces_what_it_is_made_of(tmp_path: Path) -> None:
    program = tmp_path / "part.stpnc"
    program.write_bytes((PARTS / "paper000.stpnc").read_bytes())
    with pytest.raises(StepNcError):
        simulated_with_document(
            SimulationRequest(machine="paper000"),
            RunFiles(file=program),
            program,
            DocumentChoice(),
        )
    assert program.read_bytes() == (PARTS / "paper000.stpnc").read_bytes()
