"""What a job is given to work with: its request, its folder, and whom to tell."""

import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import orjson

from service.depot import jobs
from service.depot.folder import Depot
from service.depot.jobs import Job, Kind
from service.errors import NotFound, Unavailable
from service.files import write_atomically
from service.live.folder import LiveFolder
from service.live.storage import storing
from service.progress import share_in

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
class Task:
    """A job that runs. Running state."""

    depot: Depot
    job: Job
    _said: float = field(default=0.0)

    @property
    def request(self) -> dict[str, Any]:
        """As it was asked for."""
        return dict(self.job.request)

    @property
    def folder(self) -> Path:
        """Where results go."""
        return self.depot.job_folder(self.job.id)

    @property
    def live(self) -> LiveFolder:
        """Where those look who watch it."""
        return LiveFolder(path=self.folder)

    def tell(self, message: str) -> None:
        """A word of progress, not too often; warnings come in results."""
        share = share_in(message)
        if share is not None:
            self.progress(share, message.split("]", 1)[-1].strip())

    def progress(self, share: float, message: str) -> None:
        """How far it is; the next word does when the database does not answer."""
        now = time.monotonic()
        if now - self._said >= APART:
            self._said = now
            with suppress(Unavailable):
                jobs.tell(self.depot, self.job, share=min(share, 1.0), message=message)

    def keep(self, result: Any) -> None:
        """Write the result; numpy's arrays become lists, NaN becomes null."""
        option = orjson.OPT_SERIALIZE_NUMPY | orjson.OPT_NON_STR_KEYS
        write_atomically(self.folder / RESULT, orjson.dumps(result, option=option))

    def make_folder(self) -> None:
        """Where results go, without what another attempt has left half done."""
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
        return program_file(self.depot, program=self.job.program, source=self.job.source)


def clear(folder: Path, patterns: Sequence[str]) -> None:
    """Remove files of a job; one that cannot be removed stays."""
    for pattern in patterns:
        for file in folder.glob(pattern):
            with suppress(OSError):
                file.unlink()


def program_file(depot: Depot, *, program: str, source: str) -> tuple[Path, str]:
    """The bytes of a program, or of what an advice made of it, and what it is called.

    Raises
    ------
    NotFound
        When there is none.
    """
    from service.depot import programs  # noqa: PLC0415 (used by those who need a name)

    name = programs.get(depot, program).name
    if not source:
        return depot.program_file(program), name
    jobs.get(depot, source, Kind.ADVICE)
    file = depot.job_folder(source) / OPTIMISED
    if not file.is_file():
        raise NotFound("optimised program of advice", source)
    return file, optimised_name(name)


def optimised_name(name: str) -> str:
    """What a program is called once it is optimised."""
    return f"{Path(name).stem}.optimised.stpnc"
