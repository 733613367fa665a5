"""Recorded runs that an agent publishes again: samples, MTConnect documents, SHDR logs.

Files are read in pieces, so that memory stays bounded. Times count from the first record.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import inf, nan
from pathlib import Path

import numpy as np
import pyarrow as pa

from extras.agent.model.agent import Agent
from extras.agent.model.buffer import Value
from extras.agent.model.machine_feed import RunFeed
from extras.agent.model.model import DeviceModel
from extras.agent.model.shdr import item_of, read_line
from extras.agent.model.streams_document import read_streams
from service.files import require_regular
from service.progress import Tell
from service.recording.table import TABLES, batches, headings
from simulator.client.columns import TIME, column_name
from simulator.client.connection import items_of
from simulator.motion.segments import Floats, Ints
from stepnc_model.errors import StepNcError
from stepnc_model.units import US_PER_SECOND

DOCUMENTS = frozenset({".xml"})
LINES = frozenset({".shdr", ".log"})
"""Suffixes of recorded runs."""

ROWS = 8192
"""Values of lines in one piece."""

LONGEST_LINE = 1 << 16
"""Most characters of a line."""

CONTROLLED = {"force_measured": "cutting_force", "spindle_power": "c_axis_wattage"}
"""Columns of ``stepnc control`` that have another name in other files."""

SHOWN = 8
"""Most names in a message."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedRun:
    """Recorded run, as it is published by an agent."""

    devices: DeviceModel
    duration: float
    read: Callable[[], Iterator[RunFeed]]

    def feeds(self) -> Iterator[RunFeed]:
        """See :class:`extras.agent.play.PlayableRun`."""
        yield from self.read()

    def first(self, _count: int) -> Mapping[str, Value]:
        """Return the availability of the devices, unless the run tells it."""
        return {
            item.id: "AVAILABLE" for item in self.devices.items if item.type == "AVAILABILITY"
        }

    def equip(self, agent: Agent) -> None:
        """Add nothing: a recorded run has no assets."""


BY_MACHINE = "name the machine with --machine"

BY_MODEL = f"{BY_MACHINE}, or its device model with --device"
"""Options of commands that read logs, for messages."""


def read_log(
    path: Path, model: DeviceModel, *, tell: Tell, option: str = BY_MODEL
) -> RecordedRun:
    """Read the recorded run of a file, by its suffix.

    Parameters
    ----------
    path : Path
        Parquet or CSV as ``stepnc simulate`` and ``stepnc record`` write them; an MTConnect
        document of streams; SHDR lines with timestamps.
    model : DeviceModel
        Data items that the values belong to.
    tell : callable
        Takes what is left out.
    option : str
        What helps where nothing in the file belongs to the device model.

    Raises
    ------
    StepNcError
        When the file cannot be read, is damaged, or has nothing for this device model.
    """
    require_regular(path)
    suffix = path.suffix.lower()
    try:
        if suffix in TABLES:
            return _table(path, model, tell)
        if suffix in DOCUMENTS:
            return _document(path, model, tell)
        return _lines(path, model, tell)
    except NothingKnown as error:
        raise StepNcError(f"{error}: {option}") from error
    except OSError as error:
        raise StepNcError(f"{path}: cannot be read: {error}") from error


# Tables


def _table(path: Path, model: DeviceModel, tell: Tell) -> RecordedRun:
    names = headings(path)
    if TIME not in names:
        raise StepNcError(f"{path}: no column {TIME}")
    items = items_by_column(model)
    for name, usual in CONTROLLED.items():
        if usual in items and usual not in names:
            items.setdefault(name, items[usual])
    found = {name: items[name] for name in names if name in items}
    _require_some(path, list(found), [name for name in names if name != TIME])
    _tell_left_out(tell, path, [each for each in names if each not in found and each != TIME])
    begin, duration = _span(path, model, found)

    def read() -> Iterator[RunFeed]:
        held: dict[int, Value] = {}
        for batch in batches(path, _kinds(model, found)):
            times = batch.column(0).to_numpy(zero_copy_only=False) - begin
            yield _changes(batch, times, list(found.values()), model, held)

    return RecordedRun(devices=model, duration=duration, read=read)


def _span(path: Path, model: DeviceModel, items: Mapping[str, int]) -> tuple[float, float]:
    """Return the first time of a table and its duration, in s, after all rows were read once.

    Raises
    ------
    StepNcError
        When there are no rows, or times do not ascend.
    """
    begin, last, row = nan, -inf, 1
    for batch in batches(path, _kinds(model, items)):
        times: Floats = batch.column(0).to_numpy(zero_copy_only=False)
        begin = float(times[0]) if row == 1 else begin
        # Also true of a time that is missing.
        wrong = np.flatnonzero(~(times >= np.append(last, times[:-1])))
        if len(wrong):
            at = int(wrong[0])
            raise StepNcError(
                f"{path}: row {row + at}: time {times[at]:g} s: it must not be before "
                f"{times[at - 1] if at else last:g} s"
            )
        last, row = float(times[-1]), row + len(times)
    if row == 1:
        raise StepNcError(f"{path}: no rows")
    return begin, last - begin


def _changes(
    batch: pa.RecordBatch,
    times: Floats,
    items: Sequence[int],
    model: DeviceModel,
    held: dict[int, Value],
) -> RunFeed:
    """Return the values of a piece that differ from the ones before; they are held then."""
    rows: list[Ints] = []
    numbers: list[int] = []
    values: list[Value] = []
    for place, item in enumerate(items, start=1):
        column = batch.column(place)
        is_number = model.items[item].category == "SAMPLE"
        cells = column.to_pylist() if not is_number else _cells(column)
        is_first = item not in held
        before = held.get(item)
        changed = []
        for row, cell in enumerate(cells):
            if is_first or cell != before:
                changed.append(row)
                values.append(cell)
                before, is_first = cell, False
        held[item] = before
        rows.append(np.array(changed, dtype=np.int64))
        numbers += [item] * len(changed)
    at = np.concatenate(rows)
    # Stable: data items of one moment stay in the order of the columns.
    order = np.argsort(at, kind="stable")
    return RunFeed(
        items=np.array(numbers, dtype=np.int64)[order],
        times=times[at[order]],
        values=[values[each] for each in order.tolist()],
    )


def _cells(column: pa.Array) -> list[Value]:
    """Return numbers as a list; None where a number is missing or not finite."""
    numbers = column.to_numpy(zero_copy_only=False)
    return [each if np.isfinite(each) else None for each in numbers.tolist()]


def _kinds(model: DeviceModel, items: Mapping[str, int]) -> dict[str, pa.DataType]:
    """Return the types of the time and of the other columns: texts of events, else numbers."""
    kinds = {
        name: pa.float64() if model.items[item].category == "SAMPLE" else pa.string()
        for name, item in items.items()
    }
    return {TIME: pa.float64(), **kinds}


def items_by_column(model: DeviceModel) -> dict[str, int]:
    """Return the data item of each column name; conditions and data sets have no column."""
    found: dict[str, int] = {}
    for each in items_of(model.root):
        number = model.index[each.id]
        item = model.items[number]
        if item.category == "CONDITION" or item.representation != "VALUE":
            continue
        found.setdefault(column_name(each) or each.id, number)
        found.setdefault(each.id, number)
    return found


# Documents


def _document(path: Path, model: DeviceModel, tell: Tell) -> RecordedRun:
    streams = read_streams(path, model)
    _require_some(path, streams.values, list(streams.unknown))
    _tell_left_out(tell, path, list(streams.unknown))
    seconds = (streams.times - streams.times[0]) / US_PER_SECOND
    feed = RunFeed(items=streams.items, times=seconds, values=streams.values)
    return RecordedRun(devices=model, duration=feed.duration, read=lambda: iter((feed,)))


# Lines


def _lines(path: Path, model: DeviceModel, tell: Tell) -> RecordedRun:
    begin, end, unknown, count = 0, 0, dict[str, None](), 0
    for items, times, _ in _line_pieces(path, model):
        begin = int(times[0]) if not count else begin
        end = int(times[-1])
        count += len(items)
    for line in _texts(path):
        keys = line.split("|")[1:2]
        unknown |= dict.fromkeys(key for key in keys if item_of(key.strip(), model) is None)
    _require_some(path, [count] * bool(count), list(unknown))
    _tell_left_out(tell, path, list(unknown))

    def read() -> Iterator[RunFeed]:
        for items, times, values in _line_pieces(path, model):
            yield RunFeed(items=items, times=(times - begin) / US_PER_SECOND, values=values)

    return RecordedRun(devices=model, duration=(end - begin) / US_PER_SECOND, read=read)


def _line_pieces(path: Path, model: DeviceModel) -> Iterator[tuple[Ints, Ints, list[Value]]]:
    """Yield data items, times in µs and values of lines, in the order of the file."""
    items: list[int] = []
    times: list[int] = []
    values: list[Value] = []
    last = 0
    for line in _texts(path):
        # A line without a time, or with an earlier one, belongs to the one before.
        for each in read_line(line, model, partial(int, last)):
            last = max(last, each.time)
            items.append(each.item)
            times.append(last)
            values.append(each.value)
        if len(items) >= ROWS:
            yield np.array(items), np.array(times), values
            items, times, values = [], [], []
    if items:
        yield np.array(items), np.array(times), values


def _texts(path: Path) -> Iterator[str]:
    with path.open(encoding="utf-8", errors="replace") as file:
        while line := file.readline(LONGEST_LINE):
            text = line.strip()
            if "|" in text and not text.startswith("*"):
                yield text


class NothingKnown(StepNcError):
    """No value of a log belongs to a data item of the device model."""


def _require_some(path: Path, values: Sequence[object], names: Sequence[str]) -> None:
    if not values:
        raise NothingKnown(
            f"{path}: nothing in it belongs to a data item of the device model "
            f"({_listed(names) or 'the file is empty'})"
        )


def _tell_left_out(tell: Tell, path: Path, names: Sequence[str]) -> None:
    if names:
        tell(f"{path}: left out, as the device model has no such data item: {_listed(names)}")


def _listed(names: Sequence[str]) -> str:
    more = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
    return ", ".join(names[:SHOWN]) + more
