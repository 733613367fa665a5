"""Raw parts in requests: what a JSON request cannot name, and what the command line can."""

from pathlib import Path

import pytest

from extras.verification.stored_request import QueuedVerification
from service.programs.raw_stock import raw_stock_of
from service.requests.fields import dumped, loaded
from service.requests.program_facts import ProgramRequest, StockFile, raw_part_in
from service.requests.runs import ControlRequest, SimulationRequest
from service.requests.stored_advice import StoredAdviceRequest
from service.requests.stored_cycle_time import QueuedCycleTime
from stepnc_model.errors import StepNcError
from tests.every_case import every_case
from tests.extras.verification.files import write_stl
from tests.extras.verification.model.box import box

OF_SERVICE = (
    SimulationRequest, ControlRequest, QueuedCycleTime, QueuedVerification, StoredAdviceRequest,
)  # fmt: skip


@every_case("kind", OF_SERVICE)
def test_no_request_of_the_service_can_hold_a_path(
    kind: type[ProgramRequest], tmp_path: Path
) -> None:
    there = write_stl(tmp_path / "raw.stl", box((0.0, 0.0, -20.0), (60.0, 40.0, 0.0)))
    for word in (
        str(there), f"{there}#1", "missing.stl", "/dev/zero", "../../raw.stl", "raw.npz",
        f"file://{there}", {"path": str(there)}, {"path": str(there), "solid": ""},
    ):  # fmt: skip
        with pytest.raises(StepNcError):
            loaded(kind, {"stock": word})
    for word in ("", "0,0,-30,100,120,5", "20,30"):
        assert dumped(loaded(kind, {"stock": word}))["stock"] == word


def test_a_text_is_never_a_path_where_a_raw_part_is_read(tmp_path: Path) -> None:
    there = write_stl(tmp_path / "raw.stl", box((0.0, 0.0, -20.0), (60.0, 40.0, 0.0)))
    for path in (there, tmp_path / "missing.stl"):
        with pytest.raises(StepNcError, match="numbers separated by commas"):
            raw_stock_of(str(path))
    assert raw_stock_of(StockFile(path=there)).triangles is not None


@every_case(
    ("text", "path", "solid"),
    [
        ("a.STL", "a.STL", ""), ("a/b.npz", "a/b.npz", ""), ("p.step#2", "p.step", "2"),
        (" p.stpnc ", "p.stpnc", ""),
    ],
)  # fmt: skip
def test_the_command_line_tells_files_by_their_ending(text: str, path: str, solid: str) -> None:
    assert raw_part_in(text) == StockFile(path=Path(path), solid=solid)


def test_the_command_line_takes_numbers_and_files_of_any_ending(tmp_path: Path) -> None:
    odd = tmp_path / "raw"
    odd.touch()
    assert raw_part_in(str(odd)) == StockFile(path=odd)
    assert raw_part_in("1,2,3") == "1,2,3"
    assert raw_part_in("") == ""
    with pytest.raises(StepNcError, match="an STL file"):
        raw_part_in("none")
