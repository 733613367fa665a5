"""Signals of a recorded run that the control loop needs, from a table of columns."""

from pathlib import Path

import numpy as np
import pyarrow as pa

from service.recording.table import TABLES, batches, headings
from simulator.client.columns import EXECUTION, RUNNING, TIME
from simulator.motion.segments import Floats
from simulator.plant.recorded import RecordedSignals
from stepnc_model.errors import StepNcError

POSITIONS = tuple(f"{axis}_axis_position_actual" for axis in "xyz")
FEED = ("path_feedrate_actual",)
FORCE = ("cutting_force", "force_measured")
POWER = ("c_axis_wattage", "spindle_power")
"""Columns as ``simulate`` and ``record`` name them, and as ``control`` does."""


def read_signals(path: Path) -> RecordedSignals:
    """Read a recorded run, from its start to its completion where the file says so.

    Raises
    ------
    StepNcError
        When the file cannot be read, lacks a column, or times do not ascend.
    """
    if path.suffix.lower() not in TABLES:
        raise StepNcError(f"{path}: expected a .parquet or .csv file of `stepnc record`")
    names = headings(path)
    for needed in ((TIME,), POSITIONS, FORCE + POWER, FEED):
        if not any(name in names for name in needed):
            raise StepNcError(f"{path}: no column {' or '.join(needed)}")
    kinds = {TIME: pa.float64()}
    kinds |= {
        name: pa.float64() for name in (*POSITIONS, *FEED, *FORCE, *POWER) if name in names
    }
    if EXECUTION in names:
        kinds[EXECUTION] = pa.string()
    table = pa.Table.from_batches(
        list(batches(path, kinds)), schema=pa.schema(list(kinds.items()))
    )
    time = _numbers(table, TIME)
    if not (np.diff(time) >= 0.0).all():
        at = int(np.flatnonzero(~(np.diff(time) >= 0.0))[0])
        raise StepNcError(
            f"{path}: row {at + 2}: time {time[at + 1]:g} s: it must not be before "
            f"{time[at]:g} s"
        )
    rows = _running(table)
    return RecordedSignals(
        time=time[rows],
        position=np.column_stack([_first(table, (name,)) for name in POSITIONS])[rows],
        feed=_first(table, FEED)[rows],
        force=_first(table, FORCE)[rows],
        power=_first(table, POWER)[rows],
    )


def _numbers(table: pa.Table, name: str) -> Floats:
    return np.asarray(table.column(name).to_numpy(), dtype=np.float64)


def _first(table: pa.Table, names: tuple[str, ...]) -> Floats:
    """Return the first column that is there; NaN without any."""
    found = next((name for name in names if name in table.column_names), None)
    return np.full(len(table), np.nan) if found is None else _numbers(table, found)


def _running(table: pa.Table) -> slice:
    """Return the rows of the first run of the program; all where it is not told."""
    if EXECUTION not in table.column_names:
        return slice(None)
    words = table.column(EXECUTION).to_pylist()
    begin = next((row for row, word in enumerate(words) if word in RUNNING), 0)
    ends = (row for row in range(begin, len(words)) if words[row] == "PROGRAM_COMPLETED")
    return slice(begin, next(ends, len(words)) + 1)
