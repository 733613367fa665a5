"""The job ``cycle-time``: the result of the command, with the owners' names."""

import json
from html import escape
from pathlib import Path

import stepnc
from service.requests.fields import dumped
from service.requests.stored_cycle_time import QueuedCycleTime
from service.storage import jobs, programs
from service.storage.jobs import JobKind, JobRequest, JobState
from service.storage.results import REPORT, RESULT
from tests.extras.verification.logs import SLOT_MACHINE, slot_log
from tests.service.jobs.conftest import Shop
from tests.service.jobs.test_verify import stored
from tests.service.rest.samples import SLOT

NAME = "slot & <b>.stpnc"


def test_names_of_owners_are_text_in_records_and_on_pages(shop: Shop) -> None:
    program = programs.add(shop.data_folder, SLOT.read_bytes(), name=NAME, owner="anna").id
    asked = JobRequest(
        kind=JobKind.CYCLE_TIME,
        request=dumped(QueuedCycleTime(machine=SLOT_MACHINE)),
        program=program,
        owner="anna",
    )
    job = shop.over(jobs.add(shop.data_folder, asked).id)
    assert (job.state, job.problem) == (JobState.SUCCEEDED, None)
    folder = shop.data_folder.job_folder(job.id)
    result, page = ((folder / each).read_text(encoding="utf-8") for each in (RESULT, REPORT))
    assert json.loads(result)["program"] == NAME
    assert escape(NAME) in page
    assert NAME not in page
    assert program not in result + page


def test_a_cycle_time_is_that_of_the_command_line(shop: Shop, tmp_path: Path) -> None:
    log = slot_log(tmp_path / "run.parquet")
    program = programs.add(shop.data_folder, SLOT.read_bytes(), name=SLOT.name, owner="anna")
    request = QueuedCycleTime(machine=SLOT_MACHINE, log_id=stored(shop, log))
    asked = JobRequest(
        kind=JobKind.CYCLE_TIME, request=dumped(request), program=program.id, owner="anna"
    )
    job = shop.over(jobs.add(shop.data_folder, asked).id)
    assert (job.state, job.problem) == (JobState.SUCCEEDED, None)
    folder = shop.data_folder.job_folder(job.id)
    wanted = stepnc.cycletime(SLOT, machine=SLOT_MACHINE, log=log)
    found = json.loads((folder / RESULT).read_bytes())
    assert found == {**json.loads(json.dumps(wanted.record())), "log": "run.parquet"}
    assert str(shop.data_folder.root) not in (folder / REPORT).read_text(encoding="utf-8")
