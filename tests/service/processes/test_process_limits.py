"""Limits that a process sets for itself, and what a job says that exceeds them."""

import signal
import subprocess
import sys
from pathlib import Path

from service.storage import jobs
from service.storage.jobs import JobKind, JobState
from tests.service.jobs.conftest import made_shop

LOWERED = """
import resource
from service.processes.process_limits import GIB, ProcessLimits, limit_process
limit_process(ProcessLimits(memory=2 * GIB, processor=100))
limit_process(ProcessLimits(memory=4 * GIB, processor=50))
print(*(resource.getrlimit(kind)[0] for kind in (resource.RLIMIT_AS, resource.RLIMIT_CPU)))
try:
    bytes(3 * GIB)
except MemoryError:
    print("refused")
"""

GREEDY = """
import sys
from service.jobs import child, verb_job
from service.processes.process_limits import GIB, ProcessLimits
from service.storage.folder import FolderAddress
verb_job.run = lambda task: bytes(4 * GIB)
address = FolderAddress(root=sys.argv[1], knowledge=sys.argv[2])
limits = ProcessLimits(memory=3 * GIB, processor=600)
child.limited_main(limits, address, sys.argv[3], int(sys.argv[4]))
"""


def said(words: str, *arguments: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", words, *arguments], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-500:]
    return done.stdout


def test_limits_are_lowered_and_never_raised() -> None:
    assert said(LOWERED).split() == [str(2 << 30), "50", "refused"]


BUSY = """
from service.processes.process_limits import GIB, ProcessLimits, limit_process
limit_process(ProcessLimits(memory=2 * GIB, processor=1))
sum(range(10 ** 12))
"""


def test_the_end_by_processor_time_can_be_told_from_other_ends() -> None:
    done = subprocess.run([sys.executable, "-c", BUSY], capture_output=True, check=False)
    assert done.returncode == -signal.SIGXCPU


def test_a_job_that_takes_too_much_memory_says_how_much_it_may(tmp_path: Path) -> None:
    shop = made_shop(tmp_path)
    job = shop.order(JobKind.ADVICE)
    claimed = jobs.claim(shop.data_folder, kinds=[job.kind])
    assert claimed is not None
    folder = shop.data_folder
    said(GREEDY, str(folder.root), folder.knowledge, job.id, str(claimed.attempt))
    found = shop.job(job.id)
    assert found.state is JobState.FAILED
    assert found.problem is not None
    assert found.problem["status"] == 507
    assert "3 GB" in found.problem["detail"]
