"""Positions and states of a logged run: from a table, an MTConnect document or an agent.

Tables have the columns that ``stepnc simulate`` and ``stepnc record`` write; a document of
streams may be that of any agent. Rows without a position are left out. Units s, mm.

Latest run of a monitored machine, from the observations that its agent still keeps.

Of several runs the latest whole one is taken, else the latest. An agent that does not tell
when programs run gives all that it keeps.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pyarrow as pa

from service.outputs.run_file import RunFile
from service.progress import Tell, silent
from service.recording.request import RecordingRequest
from service.recording.run import file_columns, file_values, record
from service.recording.table import POSITIONS, TABLES, batches, headings
from simulator.client.columns import (
    EXECUTION,
    RUNNING,
    TIME,
    Cell,
    RowMaker,
    columns_of,
    read_document,
)
from simulator.client.connection import AgentClient, ClientObservation
from simulator.errors import AgentError
from simulator.motion.segments import Floats
from stepnc_model.errors import StepNcError
from stepnc_model.plurals import counted

TOOL, WORKINGSTEP = "tool_number", "workingstep"
DOCUMENTS = frozenset({".xml"})
NUMERIC = (TIME, *POSITIONS, TOOL)
TEXTS = (EXECUTION, WORKINGSTEP)
NEEDED = (POSITIONS[0], POSITIONS[2])
"""Positions that every machine has; a lathe has no Y."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LoggedRun:
    """N samples of a run, in the order of their times."""

    time: Floats
    """Times, (N,), s, ascending."""
    position: Floats
    """Positions of X, Y and Z, (N, 3), mm; Y is 0 on a machine without it."""
    tool: Floats
    """Tool numbers, (N,); NaN where the log does not tell."""
    workingstep: tuple[str, ...]
    """Workingsteps, N long; empty where the log does not tell."""
    execution: tuple[str, ...]
    """States of the program, N long; empty where the log does not tell."""

    def __len__(self) -> int:
        return len(self.time)

    @property
    def running(self) -> slice:
        """Rows of the first run of the program; all where the log does not tell."""
        begin = next((row for row, word in enumerate(self.execution) if word in RUNNING), 0)
        ends = (
            row for row in range(begin, len(self)) if self.execution[row] == "PROGRAM_COMPLETED"
        )
        return slice(begin, next(ends, len(self) - 1) + 1)


def read_logged_run(log: str, *, tell: Tell = silent) -> LoggedRun:
    """Read the positions of a run.

    Parameters
    ----------
    log : str
        Parquet or CSV file, MTConnect document of streams, or address of an agent, whose buffer
        is read until the program is completed.
    tell : callable
        Takes messages on an agent's recording.

    Raises
    ------
    StepNcError
        When the log cannot be read, has no positions, or its times do not ascend.
    """
    if "://" in log:
        with TemporaryDirectory() as folder:
            place = Path(folder) / "run.parquet"
            wanted = RecordingRequest(is_buffered=True, is_until_completed=True)
            record(log, place, wanted, tell=tell)
            return _logged(log, _table(place))
    path = Path(log)
    suffix = path.suffix.lower()
    if suffix in TABLES:
        return _logged(log, _table(path))
    if suffix in DOCUMENTS:
        return _logged(log, _columns(read_document(path).rows()))
    raise StepNcError(
        f"{log}: expected a .parquet or .csv file, an .xml document of streams, or the address "
        "of an agent"
    )


def _table(path: Path) -> Mapping[str, Sequence[Cell] | Floats]:
    """Columns of a table."""
    names = headings(path)
    kinds = {name: pa.float64() for name in NUMERIC if name in names}
    kinds |= {name: pa.string() for name in TEXTS if name in names}
    if not kinds:
        return {}
    table = pa.Table.from_batches(
        list(batches(path, kinds)), schema=pa.schema(list(kinds.items()))
    )
    return {
        name: table.column(name).to_pylist()
        if name in TEXTS
        else table.column(name).to_numpy().astype(np.float64)
        for name in kinds
    }


def _columns(rows: Sequence[Mapping[str, Cell]]) -> Mapping[str, Sequence[Cell] | Floats]:
    """Columns of rows."""
    names = rows[0].keys() if rows else ()
    return {
        name: [row[name] for row in rows]
        if name in TEXTS
        else np.array([row[name] for row in rows], dtype=np.float64)
        for name in (*NUMERIC, *TEXTS)
        if name in names
    }


def _logged(log: str, columns: Mapping[str, Sequence[Cell] | Floats]) -> LoggedRun:
    """Run of some columns, checked."""
    for needed in (TIME, *NEEDED):
        if needed not in columns:
            raise StepNcError(f"{log}: no column {needed}")
    time = np.asarray(columns[TIME], dtype=np.float64)
    if not len(time):
        raise StepNcError(f"{log}: no rows")
    wrong = np.flatnonzero(~(np.diff(time) >= 0.0))
    if len(wrong):
        at = int(wrong[0])
        raise StepNcError(
            f"{log}: row {at + 3}: time {time[at + 1]:g} s: it must not be before "
            f"{time[at]:g} s"
        )
    nothing = np.zeros(len(time))
    places = [np.asarray(columns.get(name, nothing), dtype=np.float64) for name in POSITIONS]
    position = np.column_stack(places)
    known = np.flatnonzero(np.isfinite(position).all(axis=1))
    if not len(known):
        raise StepNcError(f"{log}: no row has a position")
    return LoggedRun(
        time=time[known],
        position=position[known],
        tool=np.asarray(columns.get(TOOL, nothing * np.nan), dtype=np.float64)[known],
        workingstep=_words(columns.get(WORKINGSTEP), known.tolist()),
        execution=_words(columns.get(EXECUTION), known.tolist()),
    )


def _words(column: "Sequence[Cell] | Floats | None", rows: Sequence[int]) -> tuple[str, ...]:
    """Texts of some rows; empty without a column or a text."""
    if column is None:
        return ("",) * len(rows)
    return tuple(str(column[row] or "") for row in rows)


KEPT = frozenset({*POSITIONS, "tool_number", "workingstep", "program"})
"""Columns that are kept."""

MOST_ROWS = 1_000_000
"""Most rows of one run; a longer one is cut off at its beginning."""

PARTS = ("the agent no longer keeps its beginning", "it is still going on")
"""What a run may lack."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentRun:
    """Run that was read from an agent."""

    rows: int
    program: str
    """Program that the machine named; empty: none."""
    missing: tuple[str, ...]
    """What it lacks; empty for a whole run."""


@dataclass(kw_only=True)
class KeptRows:
    """Rows of one run. Running state."""

    is_begun: bool
    """Whether its beginning was seen."""
    is_ended: bool = False
    rows: list[Mapping[str, Cell]] = field(default_factory=list)

    @property
    def is_whole(self) -> bool:
        """True if it was seen from its beginning to its end."""
        return self.is_begun and self.is_ended

    def add(self, row: Mapping[str, Cell]) -> None:
        """Keep a row; beyond the bound the older half is given up."""
        if len(self.rows) == MOST_ROWS:
            del self.rows[: MOST_ROWS // 2]
            self.is_begun = False
        self.rows.append(row)


@dataclass(kw_only=True)
class RunFinder:
    """Finds the runs among observations. Running state."""

    maker: RowMaker
    execution: str
    """Id of the data item that tells when a program runs; empty: none does."""
    current: KeptRows | None = None
    last: KeptRows | None = None
    """Run that has ended: the latest whole one, or else the latest."""

    def take(self, observation: ClientObservation, *, is_first: bool) -> None:
        """Take an observation; the first ones hold since before the agent's oldest."""
        self._add(self.maker.rows([observation]))
        if observation.id != self.execution:
            return
        is_running = observation.value in RUNNING
        if is_running and self.current is None:
            self.current = KeptRows(is_begun=not is_first)
        elif not is_running and self.current is not None:
            self.current.is_ended = True
            if self.current.is_whole or self.last is None or not self.last.is_whole:
                self.last = self.current
            self.current = None

    def interrupt(self) -> None:
        """Note that observations were lost: what is known no longer holds."""
        self.maker.last()
        self.maker.interrupt()
        if self.current is not None:
            self.current = KeptRows(is_begun=False)

    def chosen(self) -> KeptRows | None:
        """Return the latest whole run, else the latest; None without any."""
        self._add(self.maker.last())
        is_whole = self.last is not None and self.last.is_whole
        return self.last if is_whole or self.current is None else self.current

    def _add(self, rows: Iterable[Mapping[str, Cell]]) -> None:
        for row in rows:
            if self.current is not None:
                self.current.add(row)


def keep_run(url: str, output: Path, *, tell: Tell = silent) -> AgentRun:
    """Write the latest run that an agent keeps as Parquet or CSV; its time begins at 0.

    Raises
    ------
    StepNcError
        When the agent does not answer or tells of no run, or the file cannot be written.
    """
    client = AgentClient(url)
    found = [each for each in columns_of(client.items()) if each.name in KEPT | {EXECUTION}]
    columns = tuple(each for each in found if each.name in KEPT)
    if not any(each.name in POSITIONS for each in columns):
        raise AgentError(f"{url}: the device model has no positions of axes")
    execution = next((each.id for each in found if each.name == EXECUTION), "")
    runs = RunFinder(maker=RowMaker(columns=tuple(found)), execution=execution)
    if not execution:
        runs.current = KeptRows(is_begun=True, is_ended=True)
    try:
        # What changed before the oldest observation, such as the tool, is held.
        state = client.oldest_state()
    except AgentError:
        client.rewind()
        state = ()
    for each in state:
        runs.take(each, is_first=True)
    count = 0
    for part in client.kept():
        if part.lost:
            runs.interrupt()
        for each in part.observations:
            runs.take(each, is_first=False)
        count += len(part.observations)
        tell(f"{counted(count, 'observation')} read")
    run = runs.chosen()
    if run is None or not run.rows:
        raise AgentError(f"{url}: the agent keeps no positions of a run of a program")
    begin = float(run.rows[0][TIME] or 0.0)
    rows = [{**row, TIME: round(float(row[TIME] or 0.0) - begin, 6)} for row in run.rows]
    file = RunFile(output, file_columns(columns))
    with file.closing(is_whole=True):
        file.write(file_values(rows, columns))
    program = next((str(row["program"]) for row in rows if row.get("program")), "")
    lacks = (not run.is_begun, not run.is_ended)
    return AgentRun(
        rows=len(rows),
        program=program,
        missing=tuple(text for text, does in zip(PARTS, lacks, strict=True) if does),
    )
