"""A running job: its request, its result folder, and its progress."""

import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import orjson

from service.errors import NotFound, Unavailable
from service.extras import has_package
from service.files import write_atomically
from service.live.folder import LiveFolder
from service.progress import share_in
from service.requests.fields import R, loaded
from service.requests.given import ProgramRequest
from service.requests.stock import StockFile
from service.storage import jobs
from service.storage.folder import DataFolder
from service.storage.jobs import Job, JobKind

if TYPE_CHECKING:
    from service.requests.stored_advice import StoredAdviceRequest
    from service.requests.stored_verification import QueuedVerification

P = TypeVar("P", bound=ProgramRequest)

S = TypeVar("S", bound="StoredAdviceRequest | QueuedVerification")
"""Type of requests that may name an uploaded raw part."""

RESULT = "result.json"
OPTIMISED = "optimised.stpnc"
REPORT = "report.html"
SAMPLES = "samples.parquet"
NC_CODE = "program.nc"
FEEDS = "feeds.csv"
CURVES = "curves.json"
PLACES = "places"
"""Name of the files of places, without their suffixes."""
SURFACE = "surface.parquet"
LOG = "log.parquet"

UNFINISHED = (".*", "*.partial.*")
"""File name patterns of incomplete files, which no client can request."""

LARGE = (*UNFINISHED, "series.bin", SAMPLES, f"{PLACES}.*", SURFACE, LOG)
"""File name patterns of large files, removed to recover from a full disk."""

APART = 0.5
"""Shortest time between two progress reports, in s."""


def samples_place(folder: Path) -> Path | None:
    """Place of the samples of a run; none without what writes Parquet."""
    return folder / SAMPLES if has_package("pyarrow") else None


@dataclass(kw_only=True)
class RunningJob:
    """Job in progress. Running state."""

    data_folder: DataFolder
    job: Job
    _said: float = field(default=0.0)

    def request(self, kind: type[R]) -> R:
        """Return the request of the job, with machine and material of library or shop.

        What a client names is looked up here, in the one place through which every request
        comes: the code behind it takes paths too.

        Raises
        ------
        UnknownMachine, Unreadable
            When the machine is not known, or the material is no name.
        """
        found = loaded(kind, self.job.request)
        return self._named(found) if isinstance(found, ProgramRequest) else found

    def _named(self, request: P) -> P:
        """Return the request with machine and material names of the shop replaced by paths."""
        # Slow to import; the runner and many jobs name neither.
        from service.storage.library import machine_word, material_word  # noqa: PLC0415

        words = {"machine": machine_word, "material": material_word}
        own = {
            name: word(self.data_folder, getattr(request, name))
            for name, word in words.items()
            if hasattr(request, name)
        }
        return replace(request, **own)  # type: ignore[arg-type]

    def with_stock(self, request: S, names: dict[Path, str]) -> S:
        """Return the request with the file of an uploaded raw part, and note its name.

        Raises
        ------
        NotFound
            When the file was deleted.
        """
        if request.stock_id is None:
            return request
        from service.storage import files  # noqa: PLC0415 (used by those who name one)

        path = files.require_file(self.data_folder, request.stock_id, files.FileKind.STOCK)
        names[path] = files.get(self.data_folder, request.stock_id).name
        return replace(request, stock=StockFile(path=path, solid=request.stock_solid))

    @property
    def folder(self) -> Path:
        """Folder of the results of this attempt."""
        return self.data_folder.attempt_folder(self.job.id, self.job.attempt)

    @property
    def live(self) -> LiveFolder:
        """Folder of the live data of the run."""
        return LiveFolder(path=self.folder)

    def tell(self, message: str) -> None:
        """Report progress found in a message; other messages are ignored."""
        share = share_in(message)
        if share is not None:
            self.progress(share, message.split("]", 1)[-1].strip())

    def progress(self, share: float, message: str) -> None:
        """Record the progress of the job; a failed report is not repeated."""
        now = time.monotonic()
        if now - self._said >= APART:
            self._said = now
            with suppress(Unavailable):
                jobs.tell(self.data_folder, self.job, share=min(share, 1.0), message=message)

    def keep(self, result: Any, name: str = RESULT) -> None:
        """Write the result, or another JSON file; arrays become lists, NaN becomes null."""
        option = orjson.OPT_SERIALIZE_NUMPY | orjson.OPT_NON_STR_KEYS
        write_atomically(self.folder / name, orjson.dumps(result, option=option))

    def make_folder(self) -> bool:
        """Create the result folder and remove unfinished files of an earlier attempt.

        Returns
        -------
        bool
            False if a later attempt has taken over, and nothing was created.
        """
        is_current = jobs.begin(self.data_folder, self.job)
        if is_current:
            clear(self.folder, UNFINISHED)
        return is_current

    def publish(self) -> None:
        """Show the results of this attempt to other hosts.

        Raises
        ------
        Unavailable
            When the store of files does not answer.
        """
        if self.data_folder.store is not None and self.folder.is_dir():
            self.data_folder.store.publish_folder(self.folder)

    def program_file(self) -> tuple[Path, str]:
        """Return file and name of the program to run: an upload or an optimised program.

        Raises
        ------
        NotFound
            When the program was deleted.
        """
        return program_file(self.data_folder, program=self.job.program, source=self.job.source)


def clear(folder: Path, patterns: Sequence[str]) -> None:
    """Remove files of a job that match patterns; failures are ignored."""
    for pattern in patterns:
        for file in folder.glob(pattern):
            with suppress(OSError):
                file.unlink()


def program_file(data_folder: DataFolder, *, program: str, source: str) -> tuple[Path, str]:
    """Return file and name of an uploaded program or of the program optimised by an advice.

    Raises
    ------
    NotFound
        When the program does not exist.
    """
    from service.storage import programs  # noqa: PLC0415 (used by those who need a name)

    name = programs.get(data_folder, program).name
    if not source:
        return data_folder.fetched(data_folder.program_file(program)), name
    jobs.get(data_folder, source, JobKind.ADVICE)
    file = data_folder.fetched(data_folder.job_folder(source) / OPTIMISED)
    if not file.is_file():
        raise NotFound("optimised program of advice", source)
    return file, optimised_name(name)


def optimised_name(name: str, suffix: str = ".stpnc") -> str:
    """Return the file name of the optimised version of a program."""
    return f"{Path(name).stem}.optimised{suffix}"
