"""Observations for an agent from the samples of the virtual machine."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from extras.agent.model.buffer import ConditionValue, Value
from extras.agent.model.machine_model import MachineItem, MachineModel
from extras.agent.model.tool_assets import asset_id
from simulator.client.document_choices import SchemaVersion
from simulator.machine.samples import Condition, Samples
from simulator.motion.segments import Floats, Ints
from simulator.spec import Machine

ALWAYS = (0, 0)
YOUNGER = {("EXECUTION", "WAIT"): ((1, 5), "ACTIVE")}
"""words of events: schema version from which they are known, and what stands for them before"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RunFeed:
    """N observations of a run in the order of time."""

    items: Ints
    """Numbers of the data items, (N,)"""
    times: Floats
    """Times from the start of the program, (N,), s"""
    values: list[Value]

    @property
    def duration(self) -> float:
        """Time of the last observation, in s."""
        return float(self.times[-1]) if len(self.times) else 0.0


def run_feed(
    samples: Samples, machine: Machine, shown: MachineModel, *, workingsteps: Sequence[str]
) -> RunFeed:
    """Observations of a run: each value of a data item that differs from the one before.

    Parameters
    ----------
    machine : Machine
        Whose greatest motor power is 100 % of the spindle's load.
    workingsteps : sequence of str
        Ids by their number, from 1.
    """
    parts: list[tuple[int, Ints, list[Value]]] = []
    for number, item in shown.shown:
        if item.category == "CONDITION":
            if item.id == "cload_cond":
                parts.append((number, *_overloads(samples)))
        elif item.source:
            column = _column(samples, machine, item)
            changes = _changes(column, item, workingsteps, machine.name, shown.model.version)
            parts.append((number, *changes))
    rows = np.concatenate([rows for _, rows, _ in parts])
    items = np.concatenate([np.full(len(rows), number) for number, rows, _ in parts])
    values = [value for _, _, each in parts for value in each]
    # Stable: data items of one moment stay in the order of the model.
    order = np.argsort(rows, kind="stable")
    return RunFeed(
        items=items[order],
        times=samples.time[rows[order]],
        values=[values[at] for at in order.tolist()],
    )


def beginning(
    shown: MachineModel, *, program: str, part_count: int, part: str = "", batch: str = ""
) -> dict[str, Value]:
    """Values that hold when a program starts.

    Parameters
    ----------
    program : str
        Name of the program.
    part_count : int
        Number of parts that were made before.
    part, batch : str
        Ids of the part and its batch; empty: unknown.
    """
    words: dict[str, Value] = {
        "avail": "AVAILABLE",
        "estop": "ARMED",
        "mode": "AUTOMATIC",
        "exec": "READY",
        "program": program,
        "feed_over": 100,
        "parts": part_count,
        "part": part or None,
        "batch": batch or None,
    }
    found: dict[str, Value] = {}
    for number, item in shown.shown:
        id = shown.model.items[number].id
        if item.category == "CONDITION":
            found[id] = ConditionValue(level="NORMAL")
        elif item.id in words:
            found[id] = words[item.id]
    return found


def _column(samples: Samples, machine: Machine, item: MachineItem) -> Floats:
    match item.source:
        case "spindle_load":
            greatest = max(point.power for point in machine.spindle.curve)
            return 100.0 * np.abs(samples.spindle_power) / greatest
        case "energy":
            # Each sample holds until the next, as clients take it.
            steps = np.diff(samples.time, prepend=samples.time[:1])
            before = np.concatenate(([0.0], samples.total_power[:-1]))
            energy: Floats = np.cumsum(before * steps)
            return energy
        case _:
            column: Floats = np.asarray(getattr(samples, item.source), dtype=np.float64)
            return column if item.axis is None else column[:, item.axis]


def _changes(
    column: Floats, item: MachineItem, workingsteps: Sequence[str], device: str, version: str
) -> tuple[Ints, list[Value]]:
    """Rows at which a value differs from the one before, and the values."""
    values = np.round(item.scale * column, item.digits) + 0.0
    is_known = ~np.isnan(values)
    known = np.flatnonzero(is_known)
    kept = values[known]
    differs = np.concatenate(([True], kept[1:] != kept[:-1])) if len(kept) else is_known[:0]
    rows = known[differs]
    numbers = values[rows].tolist()
    if item.source == "workingstep":
        ids = ("", *workingsteps)
        return rows, [ids[int(each)] or None for each in numbers]
    if item.type == "TOOL_ASSET_ID":
        return rows, [asset_id(device, int(each)) if each else None for each in numbers]
    if item.words:
        return _worded(rows, [item.words[int(each)] for each in numbers], item, version)
    if item.category == "EVENT":
        return rows, [int(each) for each in numbers]
    return rows, numbers


def _worded(
    rows: Ints, words: list[str], item: MachineItem, version: str
) -> tuple[Ints, list[Value]]:
    """Words of an event that a schema version knows; without one, the last one holds."""
    kept: list[int] = []
    values: list[Value] = []
    for row, word in zip(rows.tolist(), words, strict=True):
        since, older = YOUNGER.get((item.type, word), (ALWAYS, ""))
        shown = word if SchemaVersion(version).key >= since else older
        if shown and (not values or shown != values[-1]):
            kept.append(row)
            values.append(shown)
    return np.array(kept, dtype=np.int64), values


def _overloads(samples: Samples) -> tuple[Ints, list[Value]]:
    """Changes of the condition of the main drive."""
    levels = np.asarray(samples.overload)
    rows = np.flatnonzero(np.concatenate(([True], levels[1:] != levels[:-1])))
    texts = {
        Condition.NORMAL: "",
        Condition.WARNING: "above the continuous power or the permitted force",
        Condition.FAULT: "half as much again above the continuous power",
    }
    values: list[Value] = []
    for level in levels[rows].tolist():
        kind = Condition(level)
        values.append(
            ConditionValue(
                level=kind.name,
                native_code="" if kind is Condition.NORMAL else "overload",
                text=texts[kind],
            )
        )
    return rows, values
