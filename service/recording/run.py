"""Records what a machine's MTConnect agent tells into a Parquet or CSV file.

Rows of a recording as lines of a CSV file, on the disk before they are announced.

A Parquet file can only be read once its last bytes are written. So a recording writes its rows
here too, as they come; the file goes when that of the recording has its name. What is left
after a power cut or ``kill -9`` is a table that every command reads which reads a recording,
but for a last line that may be cut off.
"""

import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from service.outputs.run_file import (
    ColumnKind,
    CsvRows,
    RunColumn,
    RunFile,
    Values,
    require_suffix,
    words_of,
)
from service.progress import Tell, silent
from service.recording.request import RecordingRequest
from service.requests.fields import require_bounds
from simulator.client.columns import (
    EXECUTION,
    RUNNING,
    TIME,
    Cell,
    RecordedColumn,
    RowMaker,
    columns_of,
)
from simulator.client.connection import AgentClient, ClientObservation, StreamPart
from simulator.errors import AgentError
from stepnc_model.errors import StepNcError, WriteError
from stepnc_model.plurals import counted

if TYPE_CHECKING:
    from io import BufferedWriter


class RowJournal:
    """Open journal of a recording. Running state.

    Parameters
    ----------
    path : Path
        File that the recording will have; the journal stands beside it, as ``.partial.csv``.

    Raises
    ------
    WriteError
        When the disk refuses.
    """

    def __init__(self, path: Path, columns: Sequence[RunColumn]) -> None:
        self.place = path
        try:
            self.place, self._stream = _opened(path)
            self._rows = CsvRows(self._stream, columns)
        except OSError as error:
            raise self._refused(error) from error

    def write(self, values: Sequence[Values]) -> None:
        """Hand rows over to the operating system, which keeps them when this process dies.

        Raises
        ------
        WriteError
            When the disk refuses.
        """
        try:
            self._rows.write(values)
            self._stream.flush()
        except OSError as error:
            raise self._refused(error) from error

    def sync(self) -> None:
        """Wait until all rows are on the disk, which keeps them when the power fails.

        Raises
        ------
        WriteError
            When the disk refuses.
        """
        try:
            os.fsync(self._stream.fileno())
        except OSError as error:
            raise self._refused(error) from error

    def close(self) -> None:
        """Close the file and leave it."""
        # What the disk has refused once it refuses again.
        with suppress(OSError):
            self._stream.close()

    def remove(self) -> None:
        """Remove the file: its rows stand in that of the recording."""
        self.close()
        self.place.unlink(missing_ok=True)

    def _refused(self, error: OSError) -> WriteError:
        return WriteError(error.strerror or str(error), path=str(self.place))


def _opened(path: Path) -> "tuple[Path, BufferedWriter]":
    """First free name beside a file, opened: that of a broken-off recording stays as it is."""
    number = 1
    while True:
        ending = ".partial.csv" if number == 1 else f".partial-{number}.csv"
        place = path.with_suffix(ending)
        with suppress(FileExistsError):
            return place, place.open("xb")
        number += 1


EVERY = 5.0
"""s between lines of progress"""

ROWS = 4096
"""in one group of the file"""

COMPLETED = "PROGRAM_COMPLETED"


@dataclass(frozen=True, slots=True, kw_only=True)
class Recording:
    """Result of ``record``."""

    file: Path
    rows: int
    columns: tuple[RecordedColumn, ...]
    observations: int
    lost: int
    """observations that the agent had dropped before they were read"""
    restarts: int
    faults: int
    """attempts that found no connection"""


def record(
    url: str,
    output: Path,
    request: RecordingRequest,
    *,
    tell: Tell = silent,
    clock: Callable[[], float] = time.monotonic,
) -> Recording:
    """Record until the time is over, the program is completed or the user interrupts.

    Raises
    ------
    StepNcError
        When the agent cannot be read at the beginning, or the file cannot be written.
    """
    require_bounds(request)
    require_suffix(output)
    client = AgentClient(url)
    columns = columns_of(client.items())
    if not columns:
        raise StepNcError(f"{url}: the device model has no samples")
    rows = RowMaker(columns=columns)
    if request.is_buffered:
        client.rewind()
    else:
        rows.rows(client.state())
        rows.last()
    file = RunFile(output, file_columns(columns))
    journal = RowJournal(output, file_columns(columns))
    keeper = _Keeper(
        file=file,
        journal=journal,
        columns=columns,
        rows=rows,
        tell=tell,
        clock=clock,
        is_next_run=request.is_next_run,
        is_on=not request.is_next_run,
        was_running=rows.held(EXECUTION) in {*RUNNING, None},
    )
    with _journalled(journal, tell), file.closing(is_whole=True):
        try:
            with closing(client.stream()) as parts:
                keeper.run(parts, request)
        except KeyboardInterrupt:
            tell("interrupted: the file is complete up to here")
        keeper.end()
    return keeper.recording(output)


@contextmanager
def _journalled(journal: RowJournal, tell: Tell) -> Iterator[None]:
    """Remove the journal once the file is written; leave it, and say so, where it is not."""
    try:
        yield
    except BaseException:
        journal.close()
        tell(f"rows that were recorded before: {journal.place}")
        raise
    journal.remove()


def record_kept(url: str, output: Path, *, tell: Tell = silent) -> Recording:
    """Record all that an agent keeps now, and end; what is still to come is not waited for.

    Raises
    ------
    StepNcError
        When the agent cannot be read to the end, or the file cannot be written.
    """
    require_suffix(output)
    client = AgentClient(url)
    columns = columns_of(client.items())
    if not columns:
        raise StepNcError(f"{url}: the device model has no samples")
    rows = RowMaker(columns=columns)
    try:
        # What changed before the oldest observation, such as the tool, is held.
        rows.rows(client.oldest_state())
        rows.last()
    except AgentError:
        client.rewind()
    file = RunFile(output, file_columns(columns))
    keeper = _Keeper(
        file=file, columns=columns, rows=rows, tell=tell, clock=time.monotonic,
        is_next_run=False, is_on=True, was_running=False,
    )  # fmt: skip
    with file.closing(is_whole=True):
        for part in client.kept():
            keeper.take(part)
        keeper.end()
    return keeper.recording(output)


@dataclass(kw_only=True)
class _Keeper:
    """Keeps rows until there are enough for a group of the file. Running state."""

    file: RunFile
    journal: RowJournal | None = None
    """Rows on the disk before they are announced; None: the agent still has them."""
    columns: Sequence[RecordedColumn]
    rows: RowMaker
    tell: Tell
    clock: Callable[[], float]
    is_next_run: bool
    is_on: bool
    """Whether rows are kept: not before the run that is waited for."""
    was_running: bool
    """Whether a program ran at the last observation, or may have run."""
    count: int = 0
    lost: int = 0
    restarts: int = 0
    faults: int = 0

    def __post_init__(self) -> None:
        self._waiting: list[Mapping[str, Cell]] = []
        self._told = self.clock()
        self._execution = next((each.id for each in self.columns if each.name == EXECUTION), "")
        self._is_running = False
        self.is_over = False
        self._was_running_in_row = self.was_running

    def run(self, parts: Iterator[StreamPart], request: RecordingRequest) -> None:
        """Take parts until the recording is over."""
        begin = self.clock()
        for part in parts:
            self.take(part)
            if request.duration_s is not None and self.clock() - begin >= request.duration_s:
                return
            is_ending = request.is_until_completed or request.is_next_run
            if is_ending and self._is_completed(part.observations):
                return

    def end(self) -> None:
        """Write what waits."""
        self._keep(self.rows.last())
        self._flush()

    def recording(self, output: Path) -> Recording:
        """Summary of a recording."""
        return Recording(
            file=output,
            rows=self.file.rows,
            columns=tuple(self.columns),
            observations=self.count,
            lost=self.lost,
            restarts=self.restarts,
            faults=self.faults,
        )

    def take(self, part: StreamPart) -> None:
        """Take a part, and write rows that are enough for a group."""
        if part.fault:
            self.faults += 1
            self.tell(f"no connection: {part.fault}")
        if part.lost:
            self.lost += part.lost
            self.tell(f"lost {counted(part.lost, 'observation')}: the agent's buffer ran over")
        if part.is_restarted:
            self.restarts += 1
            self.tell("the agent has begun anew")
        if part.fault or part.lost or part.is_restarted:
            self.rows.interrupt()
        self.count += len(part.observations)
        before = len(self._waiting)
        self._keep(self.rows.rows(part.observations))
        if self.journal is not None and len(self._waiting) > before:
            self.journal.write(file_values(self._waiting[before:], self.columns))
        if len(self._waiting) >= ROWS:
            self._flush()
        self._progress()

    def _keep(self, rows: Sequence[Mapping[str, Cell]]) -> None:
        """Keep rows; where the next run is waited for, from its start until it ends."""
        for row in rows:
            word = row.get(EXECUTION)
            if self.is_over:
                return
            if word is not None:
                is_running = word in RUNNING
                has_begun = is_running and not self._was_running_in_row
                self.is_over = self.is_next_run and self.is_on and not is_running
                self.is_on = self.is_on or has_begun
                self._was_running_in_row = is_running
            if self.is_on:
                self._waiting.append(row)

    def _is_completed(self, observations: Sequence[ClientObservation]) -> bool:
        """True if a program is completed of which some was seen, or its start."""
        for each in observations:
            if each.id != self._execution or each.value is None:
                continue
            if each.value == COMPLETED and self._is_running:
                return True
            is_running = each.value in RUNNING
            if is_running and not (self.is_next_run and self.was_running):
                self._is_running = True
            self.was_running = is_running
        return False

    def _progress(self) -> None:
        if self.clock() - self._told >= EVERY:
            self._told = self.clock()
            if self.journal is not None:
                self.journal.sync()
            self.tell(counted(self.file.rows + len(self._waiting), "row"))

    def _flush(self) -> None:
        if not self._waiting:
            return
        self.file.write(file_values(self._waiting, self.columns))
        self._waiting.clear()


def file_values(
    rows: Sequence[Mapping[str, Cell]], columns: Sequence[RecordedColumn]
) -> list[Values]:
    """Return rows as columns: the time, then those of the agent."""
    found: list[Values] = [np.array([row[TIME] for row in rows], float)]
    for each in columns:
        values = [row[each.name] for row in rows]
        # None is NaN among numbers.
        found.append(words_of(values) if each.is_text else np.array(values, float))
    return found


def file_columns(columns: Sequence[RecordedColumn]) -> list[RunColumn]:
    """Return the columns of the file, each with its unit and data item."""
    return [RunColumn(name=TIME, kind=ColumnKind.EXACT, unit="s")] + [
        RunColumn(
            name=each.name,
            kind=ColumnKind.WORDS if each.is_text else ColumnKind.EXACT,
            unit=each.units,
            notes={"data_item": each.id},
        )
        for each in columns
    ]
