"""Running job: its request, its folder, and its progress."""

import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, TypeVar

import orjson

from service.errors import NotFound, Unavailable
from service.files import write_atomically
from service.live.folder import LiveFolder
from service.live.storage import storing
from service.progress import share_in
from service.requests.advice import AdviceRequest
from service.requests.fields import R, loaded
from service.requests.runs import RunRequest
from service.storage import jobs
from service.storage.folder import DataFolder
from service.storage.jobs import Job, JobKind
from service.storage.library import machine_word, material_word

N = TypeVar("N", bound=AdviceRequest | RunRequest)
"""names machine and material"""

RESULT = "result.json"
OPTIMISED = "optimised.stpnc"
REPORT = "report.html"
SAMPLES = "samples.parquet"
NC_CODE = "program.nc"

UNFINISHED = (".*", "*.partial.*")
"""names of files that were being written, and that nobody can ask for"""

LARGE = (*UNFINISHED, "series.bin", SAMPLES)
"""names of files that grow with a run: a full disk recovers without them"""

APART = 0.5
"""s between two words about how far it is"""


@dataclass(kw_only=True)
class RunningJob:
    """A job that runs. Running state."""

    data_folder: DataFolder
    job: Job
    _said: float = field(default=0.0)

    def request(self, kind: type[R]) -> R:
        """Request of the job."""
        return loaded(kind, self.job.request)

    def named(self, request: N) -> N:
        """The request with machine and material of the shop by their files."""
        return replace(
            request,
            machine=machine_word(self.data_folder, request.machine),
            material=material_word(self.data_folder, request.material),
        )

    @property
    def folder(self) -> Path:
        """Folder of the results."""
        return self.data_folder.job_folder(self.job.id)

    @property
    def live(self) -> LiveFolder:
        """Folder of the live run."""
        return LiveFolder(path=self.folder)

    def tell(self, message: str) -> None:
        """A word of progress, not too often; warnings come in results."""
        share = share_in(message)
        if share is not None:
            self.progress(share, message.split("]", 1)[-1].strip())

    def progress(self, share: float, message: str) -> None:
        """Report the progress; a report that fails is made up for by the next."""
        now = time.monotonic()
        if now - self._said >= APART:
            self._said = now
            with suppress(Unavailable):
                jobs.tell(self.data_folder, self.job, share=min(share, 1.0), message=message)

    def keep(self, result: Any) -> None:
        """Write the result; numpy's arrays become lists, NaN becomes null."""
        option = orjson.OPT_SERIALIZE_NUMPY | orjson.OPT_NON_STR_KEYS
        write_atomically(self.folder / RESULT, orjson.dumps(result, option=option))

    def make_folder(self) -> None:
        """Make the folder of the results, and clear what another attempt left half done."""
        with storing("folder of the job"):
            self.folder.mkdir(mode=0o700, exist_ok=True)
            clear(self.folder, UNFINISHED)

    def program_file(self) -> tuple[Path, str]:
        """The program that is worked on, and what it is called: an upload, or an advice's.

        Raises
        ------
        NotFound
            When it was deleted.
        """
        return program_file(self.data_folder, program=self.job.program, source=self.job.source)


def clear(folder: Path, patterns: Sequence[str]) -> None:
    """Remove files of a job; one that cannot be removed stays."""
    for pattern in patterns:
        for file in folder.glob(pattern):
            with suppress(OSError):
                file.unlink()


def program_file(data_folder: DataFolder, *, program: str, source: str) -> tuple[Path, str]:
    """The bytes of a program, or of what an advice made of it, and what it is called.

    Raises
    ------
    NotFound
        When there is none.
    """
    from service.storage import programs  # noqa: PLC0415 (used by those who need a name)

    name = programs.get(data_folder, program).name
    if not source:
        return data_folder.program_file(program), name
    jobs.get(data_folder, source, JobKind.ADVICE)
    file = data_folder.job_folder(source) / OPTIMISED
    if not file.is_file():
        raise NotFound("optimised program of advice", source)
    return file, optimised_name(name)


def optimised_name(name: str) -> str:
    """File name of an optimised program."""
    return f"{Path(name).stem}.optimised.stpnc"
