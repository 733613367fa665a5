"""Logs that an agent keeps are verified as those of files."""

from pathlib import Path

import pytest

from benchmarks.verification import SHAFT, SHAFT_REQUEST
from extras.agent.requests import AgentRequest
from extras.verification.run import verify
from service.cli.main import main
from service.errors import BAD_INPUT
from service.requests.runs import SimulationRequest
from service.simulation.run import RunFiles, simulate
from stepnc_model.errors import StepNcError
from tests.extras.agent.model.conftest import serve
from tests.extras.agent.test_run import run_of, served
from tests.simulator.client.test_connection import Serve

__all__ = ["serve"]

RUN = {"control": "exact-stop", "rate_hz": 10.0}


def test_a_log_of_an_agent_is_that_of_the_file(tmp_path: Path) -> None:
    file = tmp_path / "log.parquet"
    request = SimulationRequest(machine="lathe22", **RUN)  # type: ignore[arg-type]
    simulate(request, RunFiles(file=SHAFT, output=file))
    by_file = verify(file, SHAFT, SHAFT_REQUEST)
    published: tuple[AgentRequest, object] = run_of("shaft", "lathe22", speed=0.0, **RUN)
    with served(*published) as url:  # type: ignore[arg-type]
        by_agent = verify(url, SHAFT, SHAFT_REQUEST)
    assert by_agent.log == url
    assert by_agent.facts.samples == by_file.facts.samples
    assert by_agent.volumes.logged == pytest.approx(by_file.volumes.logged, rel=1e-6)
    assert not by_agent.has_errors
    assert not [each for each in by_agent.findings if "runs" in each.message]


def test_an_agent_without_positions_is_refused(serve: Serve) -> None:
    agent = serve()
    with pytest.raises(StepNcError, match=r"http://127.*: no rows with positions"):
        verify(agent.url, SHAFT, SHAFT_REQUEST)


def test_a_lost_agent_is_bad_input(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["verify", "http://127.0.0.1:9", "--program", str(SHAFT), "--machine", "lathe22"])
    assert ended.value.code == BAD_INPUT
    assert "http://127.0.0.1:9: Connection refused" in capsys.readouterr().err
