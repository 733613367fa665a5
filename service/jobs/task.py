"""A running job: its request, its result folder, and its progress."""

import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from html import escape
from pathlib import Path
from typing import Any, TypeVar

import orjson

from service.errors import NotFound, Unavailable
from service.files import with_names, write_atomically
from service.live.journal import LiveFolder
from service.optional_packages import has_package
from service.progress import share_in
from service.requests.fields import R, loaded
from service.requests.program_facts import ProgramRequest, StockFile
from service.storage import files, jobs
from service.storage.files import FileKind
from service.storage.folder import DataFolder
from service.storage.jobs import Job, JobKind
from service.storage.results import OPTIMISED, REPORT, RESULT, SAMPLES, UNFINISHED

P = TypeVar("P", bound=ProgramRequest)

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
    names: dict[Path, str] = field(default_factory=dict)
    """Files that the job reads, with the names that their owners gave them."""
    _said: float = field(default=0.0)

    def request(self, kind: type[R]) -> R:
        """Return the request of the job, with machine, material and raw part of the service.

        What a client names is looked up here, in the one place through which every request
        comes: the code behind it takes paths too.

        Raises
        ------
        UnknownMachine, Unreadable, NotFound
            When the machine is not known, the material is no name, or the file of the raw part
            was deleted.
        """
        found = loaded(kind, self.job.request)
        return self._named(found) if isinstance(found, ProgramRequest) else found

    def _named(self, request: P) -> P:
        """Return the request with machine and material names of the shop replaced by paths."""
        # Slow to import; the runner and many jobs name neither.
        from service.storage.library import machine_word, material_word  # noqa: PLC0415

        words = {"machine": machine_word, "material": material_word}
        own: dict[str, object] = {
            name: word(self.data_folder, getattr(request, name))
            for name, word in words.items()
            if hasattr(request, name)
        }
        stock = self.upload(getattr(request, "stock_id", None), FileKind.STOCK)
        if stock is not None:
            own["stock"] = StockFile(path=stock, solid=getattr(request, "stock_solid", ""))
        return replace(request, **own)  # type: ignore[arg-type]

    def upload(self, id: str | None, kind: FileKind) -> Path | None:
        """Return an uploaded file, and note its name; None without an id.

        Raises
        ------
        NotFound
            When the file was deleted.
        """
        if id is None:
            return None
        path = files.require_file(self.data_folder, id, kind)
        self.names[path] = files.get(self.data_folder, id, kind).name
        return path

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

    def say(self, message: str) -> None:
        """Report a message with the owners' names of files, also one without a share."""
        named = with_names(message, self.names)
        if share_in(named) is None:
            self.progress(0.0, named)
        else:
            self.tell(named)

    def named(self, record: Any) -> Any:
        """Return a record with the owners' names of files."""
        if isinstance(record, str):
            return with_names(record, self.names)
        if isinstance(record, Mapping):
            return {key: self.named(value) for key, value in record.items()}
        return [*map(self.named, record)] if isinstance(record, list | tuple) else record

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

    def keep_report(self, page: str) -> None:
        """Write the report, with the owners' names of files."""
        names = {path: escape(name) for path, name in self.names.items()}
        data = with_names(page, names).encode(errors="replace")
        write_atomically(self.folder / REPORT, data)

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
        file, name = program_file(
            self.data_folder, program=self.job.program, source=self.job.source
        )
        self.names[file] = name
        return file, name


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
