"""The latest run that an agent keeps: whole ones before parts of one."""

from pathlib import Path

import pytest
from pyarrow import parquet

from service.recording.logged_run import RunFinder, keep_run
from simulator.client.columns import RecordedColumn, RowMaker
from simulator.client.connection import ClientObservation
from simulator.errors import AgentError
from tests.extras.agent.test_run import run_of, served


def test_a_whole_run_is_kept_from_its_beginning(tmp_path: Path) -> None:
    request, run = run_of("paper003_case1", "paper003", speed=0.0, rate_hz=10.0)
    told: list[str] = []
    with served(request, run) as url:
        found = keep_run(f"{url}/paper003", tmp_path / "run.parquet", tell=told.append)
    assert found.missing == ()
    assert found.program == "paper003_case1.stpnc"
    table = parquet.read_table(tmp_path / "run.parquet").to_pydict()
    assert found.rows == len(table["time_s"]) > 2000
    assert table["time_s"][0] == 0.0
    assert 1.0 in table["tool_number"]
    assert "MILL SLOT" in table["workingstep"]
    assert told[-1].endswith("observations read")


def test_a_run_whose_beginning_is_gone_says_so(tmp_path: Path) -> None:
    request, run = run_of("paper003_case1", "paper003", speed=0.0, rate_hz=10.0, buffer=4096)
    with served(request, run) as url:
        found = keep_run(f"{url}/paper003", tmp_path / "run.parquet")
    assert found.missing == ("the agent no longer keeps its beginning",)
    assert 10 < found.rows < 2000


def test_a_machine_that_nobody_answers_for_is_told(tmp_path: Path) -> None:
    with pytest.raises(AgentError, match=r"127\.0\.0\.1:1"):
        keep_run("http://127.0.0.1:1/mill", tmp_path / "run.parquet")
    assert list(tmp_path.iterdir()) == []


def found_rows(*words: str) -> tuple[list[float], bool]:
    """Positions of the run that is chosen: words change the execution, between positions."""
    columns = (
        RecordedColumn(name="x_axis_position_actual", id="x", units="mm", is_text=False),
        RecordedColumn(name="execution", id="e", units="", is_text=True),
    )
    runs = RunFinder(maker=RowMaker(columns=columns), execution="e")
    for number, word in enumerate(words):
        for id, value in (("e", word), ("x", str(number))):
            each = ClientObservation(id, number, float(number), value)
            runs.take(each, is_first=number == 0)
    run = runs.chosen()
    if run is None:
        return [], False
    return [float(row["x_axis_position_actual"] or 0.0) for row in run.rows], run.is_whole


READY, ACTIVE, DONE = "READY", "ACTIVE", "PROGRAM_COMPLETED"


@pytest.mark.parametrize(
    ("words", "rows", "is_whole"),
    [
        ((READY, ACTIVE, ACTIVE, DONE, READY), [1.0, 2.0], True),
        ((READY, ACTIVE, DONE, ACTIVE, DONE, ACTIVE), [3.0], True),
        ((ACTIVE, DONE, READY), [0.0], False),
        ((ACTIVE, DONE, ACTIVE), [2.0], False),
        ((READY, ACTIVE, "FEED_HOLD", ACTIVE), [1.0, 2.0, 3.0], False),
        ((READY, READY), [], False),
    ],
)
def test_the_latest_whole_run_is_chosen_or_else_the_latest(
    words: tuple[str, ...], rows: list[float], is_whole: bool
) -> None:
    assert found_rows(*words) == (rows, is_whole)


def test_after_lost_observations_a_run_has_no_beginning() -> None:
    column = RecordedColumn(name="x_axis_position_actual", id="x", units="mm", is_text=False)
    runs = RunFinder(maker=RowMaker(columns=(column,)), execution="e")
    for number, (id, value) in enumerate((("e", ACTIVE), ("x", "1"), ("x", "2"))):
        runs.take(ClientObservation(id, number, float(number), value), is_first=False)
    runs.interrupt()
    for number, (id, value) in enumerate((("x", "3"), ("e", DONE)), start=3):
        runs.take(ClientObservation(id, number, float(number), value), is_first=False)
    run = runs.chosen()
    assert run is not None
    assert (run.is_begun, run.is_ended) == (False, True)
    assert [row["x_axis_position_actual"] for row in run.rows] == [3.0]
