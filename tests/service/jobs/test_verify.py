"""The job ``verification``: result, report, places, surface; files have the owners' names."""

import json
import re
from pathlib import Path

import pytest
from pyarrow import csv, parquet

import stepnc
from extras.verification.stored_request import QueuedVerification
from service.requests.fields import dumped
from service.storage import jobs, programs
from service.storage.files import FileKind, FileUpload
from service.storage.jobs import Job, JobKind, JobRequest, JobState
from service.storage.results import PLACES, REPORT, RESULT, SURFACE
from tests.extras.verification.logs import SLOT_MACHINE, slot_log
from tests.service.jobs.conftest import Shop
from tests.service.rest.samples import SLOT

CELL = 0.5


def stored(shop: Shop, path: Path, kind: FileKind = FileKind.LOG) -> str:
    with FileUpload(shop.data_folder, kind, path.name) as upload:
        upload.write(path.read_bytes())
        upload.close()
        return upload.keep(owner="anna").id


def ordered(shop: Shop, **words: object) -> Job:
    program = programs.add(shop.data_folder, SLOT.read_bytes(), name=SLOT.name, owner="anna").id
    request = dumped(QueuedVerification(machine=SLOT_MACHINE, cell_mm=CELL, **words))  # type: ignore[arg-type]
    asked = JobRequest(
        kind=JobKind.VERIFICATION, request=request, program=program, owner="anna"
    )
    return shop.over(jobs.add(shop.data_folder, asked).id)


def test_a_verification_is_that_of_the_command_line(shop: Shop, tmp_path: Path) -> None:
    log = slot_log(tmp_path / "run.parquet", lower=0.1)
    job = ordered(shop, log_id=stored(shop, log))
    assert (job.state, job.problem) == (JobState.SUCCEEDED, None)
    folder = shop.data_folder.job_folder(job.id)
    found = stepnc.verify(log, program=SLOT, machine=SLOT_MACHINE, cell_mm=CELL)
    wanted = json.loads(json.dumps(found.record()))
    assert json.loads((folder / RESULT).read_bytes()) == wanted
    assert wanted["has_errors"]
    places = parquet.read_table(folder / f"{PLACES}.parquet")
    assert csv.read_csv(folder / f"{PLACES}.csv").num_rows == places.num_rows > 100
    assert parquet.read_metadata(folder / SURFACE).num_rows > places.num_rows
    report = (folder / REPORT).read_text(encoding="utf-8")
    assert report.startswith("<!DOCTYPE html>")
    for file in (RESULT, REPORT):
        assert str(shop.data_folder.root).encode() not in (folder / file).read_bytes()


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ("inches", "run.parquet: positions span .* they are in inches"),
        (
            "elsewhere",
            "run.parquet: .* path of paper003_case1.stpnc: is it a run of this program",
        ),
        ("times", "run.parquet: row .*: time .* must not be before"),
    ],
)
def test_a_log_that_cannot_be_verified_is_told_by_its_name(
    change: str, told: str, shop: Shop, tmp_path: Path
) -> None:
    log = slot_log(tmp_path / "run.parquet", change=change)
    job = ordered(shop, log_id=stored(shop, log))
    assert job.state is JobState.FAILED
    assert job.problem is not None
    assert job.problem["status"] == 422
    assert re.match(told, job.problem["detail"])


def test_tools_of_another_program_are_told_by_their_name(shop: Shop, tmp_path: Path) -> None:
    tools = tmp_path / "measured.toml"
    tools.write_text('[[tool]]\nnumber = 40\nkind = "endmill"\ndiameter_mm = 10\n', "utf-8")
    log = stored(shop, slot_log(tmp_path / "run.parquet"))
    job = ordered(shop, log_id=log, tools_id=stored(shop, tools, FileKind.TOOLS))
    assert job.problem is not None
    assert job.problem["detail"].startswith("measured.toml: T40 is not in the program")


def test_an_agent_that_does_not_answer_is_told(shop: Shop) -> None:
    job = ordered(shop, monitor="mill", agent_url="http://127.0.0.1:1/mill")
    assert job.problem is not None
    assert "127.0.0.1:1" in job.problem["detail"]
