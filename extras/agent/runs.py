"""Repository of runs: what an agent published, kept beyond its buffer.

Each run of a program is a Parquet file with its observations and, as metadata, the device model
and what it can be found by: machine, part, times and workingsteps. A run begins when EXECUTION
says that a program runs, and ends with the program; its file gets its name then.

References
----------
.. [1] S.-J. Shin, J. Woo, D. B. Kim, S. Kumaraguru, S. Rachuri, "Developing a virtual machining
   model to generate MTConnect machine-monitoring data from STEP-NC", Int. J. Prod. Res. 54
   (2016), 5.2: the data repository.
"""

import json
import os
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from pyarrow import parquet

from extras.agent.model.agent import Agent
from extras.agent.model.buffer import (
    AssetReference,
    ConditionValue,
    ObservationBuffer,
    TimeSeriesValue,
    Value,
)
from extras.agent.model.documents import timestamp
from extras.agent.model.model import devices_text, model_of
from service.files import plain_name
from service.progress import Tell, silent
from simulator.client.columns import RUNNING
from simulator.client.xml_text import parsed
from simulator.motion.segments import Ints
from stepnc_model.errors import StepNcError, WriteError

ROWS = 8192
"""Observations in one group of a file."""

MOST = 1 << 22
"""Most observations of a run that can be served."""

ENDED = frozenset({"PROGRAM_COMPLETED", "PROGRAM_STOPPED", "STOPPED", "READY", "UNAVAILABLE"})
"""Words of EXECUTION with which a run ends."""

NAMING = ("PART_UNIQUE_ID", "PART_ID", "PROGRAM")
"""Types whose value names the part, the best first."""

SCHEMA = pa.schema([
    ("item", pa.dictionary(pa.int32(), pa.string())),
    pa.field("time", pa.int64(), metadata={"unit": "µs since 1970"}),
    ("number", pa.float64()),
    ("text", pa.string()),
    ("kind", pa.dictionary(pa.int32(), pa.string())),
])


@dataclass(frozen=True, slots=True, kw_only=True)
class KeptWorkingstep:
    """A workingstep in a run."""

    id: str
    first: int
    """Sequence number of its first observation in the run."""
    last: int


@dataclass(frozen=True, slots=True, kw_only=True)
class KeptRun:
    """Properties by which a run of the repository is found."""

    id: str
    machine: str
    part: str
    """Id of the part; without one, the name of the program."""
    program: str
    begin: str
    """ISO 8601, UTC."""
    end: str
    observations: int
    is_completed: bool
    """Whether the program came to its end."""
    workingsteps: tuple[KeptWorkingstep, ...]


class RunRepository:
    """Runs in a folder.

    Parameters
    ----------
    folder : Path
        Made if it is not there.

    Raises
    ------
    WriteError
        When the folder cannot be made.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._known: dict[str, tuple[int, KeptRun]] = {}
        try:
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        except OSError as error:
            raise WriteError(error.strerror or str(error), path=str(folder)) from error

    def runs(self) -> list[KeptRun]:
        """Return all runs, the latest first; files that cannot be read are left out."""
        found = [run for file in self.folder.glob("*.parquet") if (run := self._read(file))]
        return sorted(found, key=lambda run: run.begin, reverse=True)

    def run(self, id: str) -> KeptRun | None:
        """Return a run; None if there is none of that id."""
        return self._read(self._file(id))

    def load(self, id: str) -> Agent:
        """Return an agent that holds the observations of a run.

        Raises
        ------
        StepNcError
            When the file cannot be read, or has too many observations.
        """
        file = self._file(id)
        try:
            table = parquet.read_table(file)
            words = parquet.read_metadata(file).metadata
            root = parsed(words[b"devices"], what=str(file))
        except (OSError, pa.ArrowException, KeyError) as error:
            raise StepNcError(f"{file}: cannot be read: {error}") from error
        if len(table) > MOST:
            raise StepNcError(f"{file}: {len(table)} observations; at most {MOST} are served")
        model = model_of(root, words[b"version"].decode())
        times = table.column("time").to_numpy()
        count = len(table) + len(model.items)
        end = int(times[-1])
        agent = Agent(model=model, clock=lambda: end, size=max(count, 1), begin=int(times[0]))
        _restart(agent, int(times[0]))
        items = [model.index[id] for id in table.column("item").to_pylist()]
        agent.add(np.array(items, dtype=np.int64), times, list(_values(table)))
        return agent

    def _file(self, id: str) -> Path:
        return self.folder / f"{plain_name(id)}.parquet"

    def _read(self, file: Path) -> KeptRun | None:
        """Return the description of a run; from memory if the file is the same."""
        try:
            changed = file.stat().st_mtime_ns
            kept = self._known.get(file.stem)
            if kept is not None and kept[0] == changed:
                return kept[1]
            words = json.loads(parquet.read_metadata(file).metadata[b"run"])
        except (OSError, pa.ArrowException, KeyError, TypeError, ValueError):
            return None
        steps = tuple(KeptWorkingstep(**step) for step in words.pop("workingsteps"))
        run = KeptRun(**words, workingsteps=steps)
        self._known[file.stem] = changed, run
        return run


def _restart(agent: Agent, begin: int) -> None:
    """Take back what an agent tells of itself, so that sequences follow from the run alone."""
    agent.buffer = ObservationBuffer(model=agent.model, size=agent.size, now=begin)


@dataclass(kw_only=True)
class _OpenRun:
    """A run that is being kept. Running state."""

    begin: int
    file: Path
    writer: parquet.ParquetWriter
    rows: list[dict[str, Any]] = field(default_factory=list)
    count: int = 0
    names: dict[str, str] = field(default_factory=dict)
    """Values of PROGRAM and of the ids of the part, by type."""
    last_time: int = 0
    workingsteps: list[KeptWorkingstep] = field(default_factory=list)
    step: tuple[str, int] | None = None
    """Running workingstep, and the row with which it began."""
    ended: int | None = None
    """When the program ended; what comes at the same time still belongs to the run."""
    is_completed: bool = False


class RunKeeper:
    """Keeps the runs of an agent in a repository. Running state.

    Parameters
    ----------
    agent : Agent
        Its observations are watched from now on.
    tell : callable
        Takes why a run cannot be kept; publishing goes on.
    """

    def __init__(self, agent: Agent, repository: RunRepository, *, tell: Tell = silent) -> None:
        self._agent, self._repository, self._tell = agent, repository, tell
        self._open: dict[int, _OpenRun] = {}
        model = agent.model
        self._device = np.array([
            model.components[item.component].device for item in model.items
        ])
        self._types = [item.type for item in model.items]
        self._held: dict[int, Value] = {
            item: entries[-1].value
            for item, entries in enumerate(agent.buffer.state)
            if entries and entries[-1].value is not None
        }
        """Last value of each data item; the buffer may be ahead."""
        agent.watchers.append(self.watch)

    def watch(self, items: Ints, times: Ints, values: Sequence[Value]) -> None:
        """Keep observations that belong to a run."""
        for item, time, value in zip(items.tolist(), times.tolist(), values, strict=True):
            device = int(self._device[item])
            try:
                self._take(device, item, time, value)
            except WriteError as error:
                self._open.pop(device, None)
                self._tell(f"a run is not kept: {error}")
            self._held[item] = value

    def close(self) -> None:
        """End the runs that are still open."""
        for device in list(self._open):
            self._end(device)

    def _take(self, device: int, item: int, time: int, value: Value) -> None:
        run = self._open.get(device)
        is_execution = self._types[item] == "EXECUTION"
        if run is not None and run.ended is not None and time > run.ended:
            self._end(device)
            run = None
        if run is None and is_execution and value in RUNNING:
            run = self._open[device] = self._begun(device, time)
        if run is None:
            return
        self._add(run, item, time, value)
        if is_execution and str(value or "UNAVAILABLE") in ENDED:
            run.ended, run.is_completed = time, value == "PROGRAM_COMPLETED"

    def _begun(self, device: int, time: int) -> _OpenRun:
        """Begin a run with what holds of its device."""
        model = self._agent.model
        entries = [
            (item, value)
            for item in sorted(model.items_of(device))
            if self._types[item] != "EXECUTION" and _is_known(value := self._held.get(item))
        ]
        name = plain_name(f"{model.devices[device].name}-{timestamp(time)}".replace(":", ""))
        file = self._repository.folder / f"{name}.parquet"
        try:
            writer = parquet.ParquetWriter(file.with_suffix(".partial"), SCHEMA)
        except OSError as error:
            raise WriteError(error.strerror or str(error), path=str(file)) from error
        run = _OpenRun(begin=time, file=file, writer=writer)
        for item, value in entries:
            self._add(run, item, time, value)
        return run

    def _add(self, run: _OpenRun, item: int, time: int, value: Value) -> None:
        run.last_time = max(run.last_time, time)
        if self._types[item] in NAMING and value is not None:
            run.names.setdefault(self._types[item], str(value))
        if self._types[item] == "PROCESS_KIND_ID":
            self._turn(run, str(value or ""))
        run.rows.append({
            "item": self._agent.model.items[item].id, "time": run.last_time, **_cells(value)
        })  # fmt: skip
        run.count += 1
        if len(run.rows) >= ROWS:
            self._flush(run)

    def _turn(self, run: _OpenRun, id: str) -> None:
        """Note which workingstep runs from here on."""
        first = len(self._agent.model.items) + 1
        if run.step is not None:
            name, begin = run.step
            step = KeptWorkingstep(id=name, first=first + begin, last=first + run.count - 1)
            run.workingsteps.append(step)
        run.step = (id, run.count) if id else None

    def _flush(self, run: _OpenRun) -> None:
        try:
            run.writer.write_table(pa.Table.from_pylist(run.rows, schema=SCHEMA))
        except OSError as error:
            raise WriteError(error.strerror or str(error), path=str(run.file)) from error
        run.rows.clear()

    def _end(self, device: int) -> None:
        run = self._open.pop(device)
        self._turn(run, "")
        self._flush(run)
        model = self._agent.model
        kept = KeptRun(
            id=run.file.stem,
            machine=model.devices[device].name,
            part=next((run.names[kind] for kind in NAMING if kind in run.names), ""),
            program=run.names.get("PROGRAM", ""),
            begin=timestamp(run.begin),
            end=timestamp(run.last_time),
            observations=run.count,
            is_completed=run.is_completed,
            workingsteps=tuple(run.workingsteps),
        )
        run.writer.add_key_value_metadata({
            "run": json.dumps(asdict(kept), ensure_ascii=False),
            "devices": devices_text(model),
            "version": model.version,
        })
        try:
            run.writer.close()
            os.replace(run.file.with_suffix(".partial"), run.file)
        except OSError as error:
            raise WriteError(error.strerror or str(error), path=str(run.file)) from error


def _is_known(value: Value) -> bool:
    if isinstance(value, ConditionValue):
        return value.level != "UNAVAILABLE"
    return value is not None


def _cells(value: Value) -> dict[str, Any]:
    match value:
        case None:
            return {"kind": "unavailable"}
        case ConditionValue():
            return {"kind": "condition", "text": json.dumps(asdict(value))}
        case TimeSeriesValue():
            return {"kind": "series", "text": json.dumps(asdict(value))}
        case AssetReference():
            return {"kind": "asset", "text": json.dumps(asdict(value))}
        case dict():
            return {"kind": "set", "text": json.dumps(value)}
        case str():
            return {"kind": "text", "text": value}
        case int():
            return {"kind": "whole", "number": float(value)}
        case _:
            return {"kind": "number", "number": float(value)}


def _values(table: pa.Table) -> Iterator[Value]:
    columns = (table.column(name).to_pylist() for name in ("kind", "number", "text"))
    for kind, number, text in zip(*columns, strict=True):
        match kind:
            case "number":
                yield number
            case "whole":
                yield int(number)
            case "text":
                yield text
            case "condition":
                yield ConditionValue(**json.loads(text))
            case "series":
                words = json.loads(text)
                yield TimeSeriesValue(values=tuple(words["values"]), rate=words["rate"])
            case "asset":
                yield AssetReference(**json.loads(text))
            case "set":
                yield json.loads(text)
            case _:
                yield None
