"""Positions of a logged run: the same from a table, a document and an agent."""

from pathlib import Path

import numpy as np
import pytest

from extras.agent.run import simulated_with_document
from service.recording.logged_run import read_logged_run
from service.requests.runs import SimulationRequest
from service.simulation.run import RunFiles
from simulator.client.document_choices import DocumentChoice, NameSet, SchemaVersion
from stepnc_model.errors import StepNcError
from tests.every_case import every_case
from tests.extras.agent.test_run import PARTS, run_of, served

REQUEST = SimulationRequest(machine="paper003", rate_hz=10.0)


def test_table_document_and_agent_tell_the_same_run(tmp_path: Path) -> None:
    table, document = tmp_path / "run.parquet", tmp_path / "run.xml"
    files = RunFiles(file=PARTS / "paper003_case1.stpnc", output=table)
    choice = DocumentChoice(version=SchemaVersion.V2_7, names=NameSet.MODERN, part="", batch="")
    simulated_with_document(REQUEST, files, document, choice, tell=lambda _: None)
    request, run = run_of("paper003_case1", "paper003", speed=0.0, rate_hz=10.0)
    with served(request, run) as url:
        runs = [read_logged_run(log) for log in (str(table), str(document), f"{url}/paper003")]
    for each in runs:
        assert each.time[-1] == pytest.approx(runs[0].time[-1])
        # Positions count as they were told; a value that did not change is not told again.
        places = np.interp(np.arange(0.0, 250.0, 5.0), each.time, each.position[:, 0])
        truth = np.interp(np.arange(0.0, 250.0, 5.0), runs[0].time, runs[0].position[:, 0])
        assert np.allclose(places, truth, atol=0.01)
        assert each.workingstep[each.running][-1] == "MILL SLOT"
        assert each.execution[each.running.stop - 1] == "PROGRAM_COMPLETED"
        assert np.nanmax(each.tool) == 1.0


HEAD = "time_s,x_axis_position_actual,z_axis_position_actual\n"


@every_case(
    ("name", "text", "message"),
    [
        ("a.csv", HEAD + "0,1,2\n1,1,2\n0.5,1,2\n", "row 4: time 0.5 s: it must not be"),
        ("a.csv", HEAD, "no rows"),
        ("a.csv", HEAD + "0,,2\n1,nan,2\n", "no row has a position"),
        ("a.csv", "time_s,x_axis_position_actual\n0,1\n", "no column z_axis_position_actual"),
        ("a.csv", "seconds\n0\n", "no column time_s"),
        ("a.csv", HEAD + "0,one,2\n", "cannot be read"),
        ("a.txt", "", "expected a .parquet or .csv file"),
    ],
)  # fmt: skip
def test_bad_logs_are_told(tmp_path: Path, name: str, text: str, message: str) -> None:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    with pytest.raises(StepNcError, match=message):
        read_logged_run(str(path))


def test_rows_without_a_position_are_left_out(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(HEAD + "0,1,2\n1,,2\n1,3,2\n", encoding="utf-8")
    run = read_logged_run(str(path))
    assert run.time.tolist() == [0.0, 1.0]
    assert run.position.tolist() == [[1.0, 0.0, 2.0], [3.0, 0.0, 2.0]]
    assert run.running == slice(0, 2)
