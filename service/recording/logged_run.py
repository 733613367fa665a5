"""Positions and states of a logged run: from a table, an MTConnect document or an agent.

Tables have the columns that ``stepnc simulate`` and ``stepnc record`` write; a document of
streams may be that of any agent. Rows without a position are left out. Units s, mm.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pyarrow as pa

from service.reading import Tell, silent
from service.recording.run import record
from service.recording.signals import POSITIONS
from service.recording.table import TABLES, batches, headings
from service.requests.recording import RecordingRequest
from simulator.client.columns import EXECUTION, RUNNING, TIME, Cell
from simulator.client.document import read_document
from simulator.motion.segments import Floats
from stepnc_model.errors import StepNcError

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
