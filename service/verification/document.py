"""MTConnect documents and SHDR logs as tables of positions, tools and workingsteps.

A row stands for a time at which something was told; other columns hold their last value.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa

from service.agent.replay import BY_MACHINE, DOCUMENTS, LINES, items_by_column, read_log
from service.reading import silent
from simulator.agent.buffer import Value
from simulator.agent.machine_feed import RunFeed
from simulator.agent.machine_model import machine_model
from simulator.agent.model import DeviceModel
from simulator.agent.names import NameSet
from simulator.client.columns import TIME, WORDS
from simulator.client.document import read_document
from simulator.motion.segments import Ints
from simulator.spec import Machine
from stepnc_model.errors import StepNcError

SUFFIXES = DOCUMENTS | LINES
"""Suffixes of documents and logs."""


def table_of(path: Path, machine: Machine, columns: Sequence[str]) -> pa.Table:
    """Read columns of a document of streams of any agent, or an SHDR log of a machine.

    Parameters
    ----------
    path : Path
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
