"""Log of positions in pieces: columns of a log as samples in program coordinates.

Axes that have no value at a time are interpolated over time between their own values. Pieces
are bounded, so that logs of any length need the memory of one piece.

MTConnect documents and SHDR logs as tables of positions, tools and workingsteps.

A row stands for a time at which something was told; other columns hold their last value.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf
from pathlib import Path

import numpy as np
import pyarrow as pa

from extras.agent.model.buffer import Value
from extras.agent.model.machine_feed import RunFeed
from extras.agent.model.machine_model import machine_model
from extras.agent.model.model import DeviceModel
from extras.agent.replay import BY_MACHINE, DOCUMENTS, LINES, items_by_column, read_log
from extras.verification.axes import without_held
from extras.verification.model.logged_part import LoggedSamples, joined
from service.progress import silent
from service.recording.table import POSITIONS, TABLES, batches, headings
from simulator.client.columns import EXECUTION, RUNNING, TIME, WORDS, read_document
from simulator.client.document_choices import NameSet
from simulator.motion.segments import AXES, Floats, Ints
from simulator.spec import Machine
from stepnc_model.errors import StepNcError

SUFFIXES = DOCUMENTS | LINES
"""Suffixes of documents and logs."""


def table_of(path: Path, machine: Machine, columns: Sequence[str]) -> pa.Table:
    """Read columns of a document of streams of any agent, or an SHDR log of a machine.

    Parameters
    ----------
    machine : Machine
        Machine whose data items, in modern names or those of the papers, the log has.
    columns : sequence of str
        Names of columns; those that the log does not tell are left out.

    Raises
    ------
    StepNcError
        When the file cannot be read, or has nothing of this machine.
    """
    refused: StepNcError | None = None
    for names in NameSet:
        model = machine_model(machine, names=names).model
        try:
            feeds = read_log(path, model, tell=silent, option=BY_MACHINE).feeds()
            return _table(_joined(feeds), model, columns)
        except StepNcError as error:
            refused = refused or error
    if path.suffix.lower() in DOCUMENTS:
        return _of_any_agent(path, columns)
    raise refused or StepNcError(f"{path}: no observations")


def _of_any_agent(path: Path, columns: Sequence[str]) -> pa.Table:
    """Rows of a document of another agent, by the types of its data items."""
    rows = read_document(path).rows()
    known = [name for name in (TIME, *columns) if rows and name in rows[0]]
    return pa.table({
        name: pa.array(
            [row[name] for row in rows], pa.string() if name in WORDS else pa.float64()
        )
        for name in known
    })


def _joined(feeds: Iterator[RunFeed]) -> RunFeed:
    parts = list(feeds)
    return RunFeed(
        items=np.concatenate([part.items for part in parts]),
        times=np.concatenate([part.times for part in parts]),
        values=[value for part in parts for value in part.values],
    )


def _table(feed: RunFeed, model: DeviceModel, columns: Sequence[str]) -> pa.Table:
    """Rows at the times of a feed, with the columns that it tells."""
    times, row = np.unique(feed.times, return_inverse=True)
    items = items_by_column(model)
    found = {TIME: pa.array(times)}
    for name in columns:
        told = np.flatnonzero(feed.items == items.get(name, -1))
        if len(told):
            values = [feed.values[each] for each in told.tolist()]
            found[name] = _held(values, row[told], len(times), is_text=name in WORDS)
    return pa.table(found)


def _held(values: Sequence[Value], rows: Ints, count: int, *, is_text: bool) -> pa.Array:
    """Values at some rows, held until the next one."""
    place = np.searchsorted(rows, np.arange(count), side="right") - 1
    kept = [None, *values]
    if is_text:
        return pa.array(
            [
                None if kept[each + 1] is None else str(kept[each + 1])
                for each in place.tolist()
            ],
            pa.string(),
        )
    numbers = np.array([_number(each) for each in kept])
    return pa.array(numbers[place + 1])


def _number(value: Value) -> float:
    """A number; NaN where it is none or unavailable."""
    try:
        return float(value) if isinstance(value, str | int | float) else float("nan")
    except ValueError:
        return float("nan")


TOOL, WORKINGSTEP = "tool_number", "workingstep"
WORK_POSITIONS = tuple(f"path_position_{axis}" for axis in "xyz")
"""Columns of the tip of the tool in work coordinates, as PATH_POSITION tells it."""
OFFSETS = tuple(f"work_offset_{axis}_mm" for axis in "xyz")
"""Columns of the position of the program's zero on the axes."""
LENGTH = "tool_length_offset_mm"
"""Column of the length of the tool, by which Z of the axes lies above the tip."""
WORK_OFFSET = "work_offset"
"""Column of the name or number of the work offset in effect."""
COMPLETED = "PROGRAM_COMPLETED"

COLUMNS = (
    *POSITIONS, TOOL, WORKINGSTEP, EXECUTION, WORK_OFFSET, *WORK_POSITIONS, *OFFSETS, LENGTH,
)  # fmt: skip
"""Columns that are read of a document."""

PIECE = 65_536
"""Samples that are taken together."""

LONGEST_WAIT = 1_000_000
"""Most samples that wait for the next value of an axis."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramNames:
    """Names that a log may use: workingsteps of the program with their tools."""

    workingsteps: Mapping[str, int]
    """Index of each workingstep by its id."""
    tool_of: Mapping[int, int]
    """Number of the tool by the index of the workingstep."""
    tools: frozenset[int]
    """Numbers of all tools."""

    def indices(self, words: Sequence[str | None], index: Ints, _: Ints) -> Ints:
        """Indices of the workingsteps of rows; -1 where they are unknown."""
        known = [-1 if word is None else self.workingsteps.get(word, -1) for word in words]
        return np.asarray(np.array(known, dtype=np.int64)[index])

    def numbers(self, words: Sequence[str | None], index: Ints) -> Ints | None:
        """Numbers of the tools of rows by their workingsteps."""
        known = [
            0 if word is None else self.tool_of.get(self.workingsteps.get(word, -1), 0)
            for word in words
        ]
        return np.asarray(np.array(known, dtype=np.int64)[index])


@dataclass(kw_only=True)
class LogSteps:
    """Workingsteps and tools that a log shows, numbered as they come. Running state."""

    tools: frozenset[int]
    """Numbers of the tools of the table."""
    index_of: dict[tuple[str, int], int] = field(default_factory=dict)
    """Index by id of the workingstep, which may be empty, and number of the tool."""

    def indices(self, words: Sequence[str | None], index: Ints, tools: Ints) -> Ints:
        """Indices of the workingsteps and tools of rows."""
        count = len(words)
        pairs, row = np.unique(tools * count + index, return_inverse=True)
        known = []
        for pair in pairs.tolist():
            number, word = divmod(pair, count)
            key = (words[word] or "", number)
            known.append(self.index_of.setdefault(key, len(self.index_of)))
        return np.asarray(np.array(known, dtype=np.int64)[row])

    def numbers(self, _words: Sequence[str | None], _index: Ints) -> Ints | None:
        """None: workingsteps tell no tool here."""
        return None


@dataclass(kw_only=True)
class LogFile:
    """Table of logged positions. Running state: what was found while it was read."""

    path: Path
    names: ProgramNames | LogSteps
    name: str = ""
    """Name in messages, if it is not the path."""
    machine: Machine | None = None
    """Machine whose data items a document has."""
    zero: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Position of the program's zero on the axes, mm."""
    is_zero_stated: bool = False
    """Whether the user states the zero, so that the log's own is not used."""
    rows: int = 0
    equal_times: int = 0
    """Rows with the time of the row before."""
    unknown: int = 0
    """Rows in which a position was missing."""
    completed: int = 0
    """Programs that were completed."""
    is_running: bool = False
    """Whether a program ran at the end."""
    work_offsets: list[str] = field(default_factory=list)
    """Names of the work offsets that the log shows, in their order."""
    foreign: set[str] = field(default_factory=set)
    """Workingsteps that the program does not have."""

    def __post_init__(self) -> None:
        self.name = self.name or str(self.path)
        self._document = self._read_document()
        self._names = (
            headings(self.path) if self._document is None else self._document.column_names
        )
        self._has_work_positions = self._has_values(WORK_POSITIONS)
        self._has_offsets = self._has_values(OFFSETS)
        for needed in (TIME, *self._positions):
            if needed not in self._names:
                raise StepNcError(f"{self.name}: no column {needed}")
        is_named = isinstance(self.names, ProgramNames)
        has_tools = TOOL in self._names or (WORKINGSTEP in self._names and is_named)
        if not has_tools and len(self.names.tools) > 1:
            columns = f"{TOOL} or {WORKINGSTEP}" if is_named else TOOL
            raise StepNcError(
                f"{self.name}: no column {columns}: there are {len(self.names.tools)} tools, "
                "and the log does not show when they change"
            )

    @property
    def zero_source(self) -> str:
        """Source of the zero, if the log states it."""
        if self._has_work_positions and not self.is_zero_stated:
            return "the tip of the tool in work coordinates, as PATH_POSITION tells it"
        if self._has_offsets and not self.is_zero_stated:
            length = f" and {LENGTH}" if LENGTH in self._names else ""
            return f"positions of the axes less work_offset_x_mm, _y_mm, _z_mm{length}"
        return ""

    @property
    def _positions(self) -> tuple[str, ...]:
        """Columns of the positions; a lathe without Y stays at 0."""
        if self._has_work_positions and not self.is_zero_stated:
            return WORK_POSITIONS
        axes = None if self.machine is None else {axis.name for axis in self.machine.axes}
        if axes is None or not axes:
            return POSITIONS
        return tuple(name for axis, name in zip(AXES, POSITIONS, strict=True) if axis in axes)

    def _read_document(self) -> pa.Table | None:
        """Read a document whole; None for a table, which is read in pieces."""
        suffix = self.path.suffix.lower()
        if suffix in TABLES:
            return None
        if suffix not in SUFFIXES or self.machine is None:
            known = ", ".join(sorted(TABLES | SUFFIXES))
            raise StepNcError(f"{self.name}: expected positions in a file of {known}")
        return table_of(self.path, self.machine, COLUMNS)

    def _has_values(self, columns: tuple[str, ...]) -> bool:
        """True if the log has some columns, and a value in each."""
        if not set(columns) <= set(self._names):
            return False
        missing = set(columns)
        for batch in self._batches(dict.fromkeys(columns, pa.float64())):
            missing -= {
                name
                for name in missing
                if np.isfinite(batch.column(name).to_numpy(zero_copy_only=False)).any()
            }
            if not missing:
                return True
        return False

    def _batches(self, kinds: Mapping[str, pa.DataType]) -> Iterator[pa.RecordBatch]:
        if self._document is None:
            return batches(self.path, kinds)
        return iter(self._document.select(list(kinds)).to_batches(max_chunksize=PIECE))

    def pieces(self) -> Iterator[LoggedSamples]:
        """Yield the samples in order.

        Raises
        ------
        StepNcError
            When the file is damaged, a time goes back, or an axis has no values.
        """
        self.rows = self.equal_times = self.unknown = self.completed = 0
        self.is_running = False
        self.work_offsets, self.foreign = [], set()
        waiting: list[LoggedSamples] = []
        last = -inf
        for batch in self._batches(self._kinds()):
            part = self._samples(batch)
            self._count_programs(batch)
            self._note_work_offsets(batch)
            self._require_ascending(part.time, last)
            last = float(part.time[-1])
            self.rows += len(part)
            waiting.append(part)
            if sum(map(len, waiting)) >= PIECE:
                whole, rest = self._known(joined(waiting))
                waiting = [rest] if len(rest) else []
                if len(whole):
                    yield whole
        if not self.rows:
            raise StepNcError(f"{self.name}: no rows with positions")
        if waiting:
            whole, rest = self._known(joined(waiting))
            if not len(whole) and len(rest) == self.rows:
                raise StepNcError(f"{self.name}: {self._lacking(rest.position)} has no values")
            if len(whole):
                yield whole

    def _kinds(self) -> dict[str, pa.DataType]:
        kinds = dict.fromkeys((TIME, *self._positions), pa.float64())
        if TOOL in self._names:
            kinds[TOOL] = pa.float64()
        if WORKINGSTEP in self._names:
            kinds[WORKINGSTEP] = pa.string()
        if EXECUTION in self._names:
            kinds[EXECUTION] = pa.string()
        if WORK_OFFSET in self._names:
            kinds[WORK_OFFSET] = pa.string()
        if self._has_offsets and self._positions != WORK_POSITIONS:
            kinds |= dict.fromkeys(OFFSETS, pa.float64())
            if LENGTH in self._names:
                kinds[LENGTH] = pa.float64()
        return kinds

    def _note_work_offsets(self, batch: pa.RecordBatch) -> None:
        """Note the work offsets that are in effect one after another."""
        if WORK_OFFSET not in self._names:
            return
        words = batch.column(WORK_OFFSET).dictionary_encode()
        index = words.indices.drop_null().to_numpy()
        known = words.dictionary.to_pylist()
        for each in index[np.append(True, np.diff(index) != 0)[: len(index)]].tolist():
            if self.work_offsets[-1:] != [known[each]]:
                self.work_offsets.append(known[each])

    def _offset(self, batch: pa.RecordBatch) -> Floats:
        """Position of the program's zero on the axes at each row, (N, 3), mm."""
        offset = np.tile(np.array(self.zero), (batch.num_rows, 1))
        if OFFSETS[0] not in batch.schema.names:
            return offset
        for axis, name in enumerate(OFFSETS):
            offset[:, axis] = batch.column(name).to_numpy(zero_copy_only=False)
        if LENGTH in batch.schema.names:
            offset[:, 2] += batch.column(LENGTH).to_numpy(zero_copy_only=False)
        return offset

    def _count_programs(self, batch: pa.RecordBatch) -> None:
        """Count the programs that are completed, and note whether one runs at the end."""
        if EXECUTION not in self._names:
            return
        words = batch.column(EXECUTION).dictionary_encode()
        known = words.dictionary.to_pylist()
        index = words.indices.fill_null(len(known)).to_numpy(zero_copy_only=False)
        is_running = np.array([word in RUNNING for word in known] + [False])[index]
        is_completed = np.array([word == COMPLETED for word in known] + [False])[index]
        before = np.append(self.is_running, is_running[:-1])
        self.completed += int(np.sum(is_completed & before))
        self.is_running = bool(is_running[-1])

    def _samples(self, batch: pa.RecordBatch) -> LoggedSamples:
        position = np.zeros((batch.num_rows, len(POSITIONS)))
        for name in self._positions:
            axis = "xyz".index(name[0] if name in POSITIONS else name[-1])
            position[:, axis] = batch.column(name).to_numpy(zero_copy_only=False)
        position -= self._offset(batch)
        words, index = self._words(batch)
        tools = self._tools(batch, words, index)
        return LoggedSamples(
            time=np.asarray(batch.column(TIME).to_numpy(zero_copy_only=False)),
            position=position,
            tool=tools,
            workingstep=self.names.indices(words, index, tools),
        )

    def _words(self, batch: pa.RecordBatch) -> tuple[list[str | None], Ints]:
        """Ids of workingsteps, with the one of each row; the last one is None."""
        if WORKINGSTEP not in self._names:
            return [None], np.zeros(batch.num_rows, dtype=np.int64)
        words = batch.column(WORKINGSTEP).dictionary_encode()
        known = words.dictionary.to_pylist()
        if isinstance(self.names, ProgramNames):
            self.foreign |= {word for word in known if word} - self.names.workingsteps.keys()
        index = words.indices.fill_null(len(known)).to_numpy(zero_copy_only=False)
        return [*known, None], np.asarray(index, dtype=np.int64)

    def _tools(self, batch: pa.RecordBatch, words: Sequence[str | None], index: Ints) -> Ints:
        """Numbers of the tools; where no column has them, those of the workingsteps."""
        if TOOL in self._names:
            numbers = batch.column(TOOL).to_numpy(zero_copy_only=False)
            return np.where(np.isnan(numbers), 0.0, numbers).astype(np.int64)
        named = self.names.numbers(words, index) if WORKINGSTEP in self._names else None
        if named is not None:
            return named
        return np.full(batch.num_rows, next(iter(self.names.tools)), dtype=np.int64)

    def _require_ascending(self, time: Floats, last: float) -> None:
        before = np.append(last, time[:-1])
        # Also true of a time that is missing.
        wrong = np.flatnonzero(~(time >= before))
        if len(wrong):
            at = int(wrong[0])
            raise StepNcError(
                f"{self.name}: row {self.rows + at + 1}: time {time[at]:g} s: it must not be "
                f"before {before[at]:g} s"
            )
        self.equal_times += int(np.sum(time == before))

    def _known(self, samples: LoggedSamples) -> tuple[LoggedSamples, LoggedSamples]:
        """Samples with interpolated positions, and those that wait for a value."""
        samples = replace(samples, position=without_held(samples.position))
        is_known = np.isfinite(samples.position)
        if is_known.all():
            return samples, samples[len(samples) :]
        self.unknown += int((~is_known).any(axis=1).sum())
        if not is_known.any(axis=0).all():
            if len(samples) > LONGEST_WAIT:
                message = f"no values in {len(samples)} rows"
                raise StepNcError(
                    f"{self.name}: {self._lacking(samples.position)} has {message}"
                )
            return samples[:0], samples
        first = int(is_known.argmax(axis=0).max())
        end = len(samples) - int(is_known[::-1].argmax(axis=0).max())
        position = samples.position.copy()
        for axis in range(3):
            rows = is_known[:, axis]
            position[:, axis] = np.interp(
                samples.time, samples.time[rows], samples.position[rows, axis]
            )
        is_measured = np.asarray(is_known.all(axis=1))
        # The last complete row stays for the interpolation of the next piece.
        known = replace(samples, position=position, is_measured=is_measured)
        return known[first:end], samples[end:]

    def _lacking(self, position: Floats) -> str:
        lacking = np.flatnonzero(~np.isfinite(position).any(axis=0))
        names = WORK_POSITIONS if self._positions == WORK_POSITIONS else POSITIONS
        return names[int(lacking[0])] if len(lacking) else names[0]


def thinned(pieces: Iterator[LoggedSamples], *, most: int) -> Sequence[Floats]:
    """Positions of every k-th sample that moved, at most a given number, (N, 3) each."""
    kept: list[Floats] = []
    stride, offset = 1, 0
    for piece in pieces:
        # A copy, as a view would keep the whole piece.
        kept.append(piece.position[offset % stride :: stride].copy())
        offset = (offset - len(piece)) % stride
        while sum(map(len, kept)) > most:
            kept = [np.concatenate(kept)[::2]]
            stride *= 2
    return kept
