"""The job ``cycle-time``: the result of the command, with the owners' names."""

import json
from pathlib import Path

import stepnc
from service.jobs.task import REPORT, RESULT
from service.requests.fields import dumped
from service.requests.stored_cycle_time import QueuedCycleTime
from service.storage import jobs, programs
from service.storage.jobs import JobKind, JobRequest, JobState
from tests.service.jobs.conftest import Shop
from tests.service.jobs.test_verify import stored
from tests.service.rest.samples import SLOT
from tests.service.verification.logs import SLOT_MACHINE, slot_log


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
