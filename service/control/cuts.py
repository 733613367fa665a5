"""Log of the cuts of a controlled run, as users of adaptive feed control know it.

A row for each workingstep in which chips were cut: times, powers, the least feed, and what was
done. Equal runs give equal bytes.
"""

import csv
from dataclasses import dataclass
from io import StringIO

from controller.orders import EventKind
from controller.record import RunRecord
from service.control.facts import ControlRow, rows
from service.control.loads import CutKey, ReferenceLoad, key_of, taught_load
from service.control.run import ControlRun
from service.rendering.columns import Column, records
from stepnc_model.units import mm_min_from_speed

PER_CENT = 100.0

ACTIONS = {
    EventKind.HOLD: "feed held",
    EventKind.STOP: "stopped",
    EventKind.WEAR: "tool change asked for",
    EventKind.BREAKAGE: "broken tooth",
    EventKind.OVER: "over set point",
    EventKind.HARDNESS: "work changed",
    EventKind.SILENCE: "safe override",
    EventKind.ASTRAY: "override not followed",
}
"""Events that a log of cuts names, in words."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LoggedCut:
    """One cut of a run, with its reference load and what was done in it."""

    row: ControlRow
    key: CutKey | None
    """What its reference load belongs to; None outside workingsteps."""
    reference: ReferenceLoad | None
    """Load that an earlier run has taught; None if none has."""
    done: tuple[str, ...]
    """What the loop did, with times."""

    @property
    def record(self) -> RunRecord:
        """Record of the cut."""
        return self.row.record

    @property
    def tool(self) -> str:
        """Id of the tool; empty outside workingsteps."""
        return "" if self.key is None else self.key.tool

    @property
    def load_percent(self) -> float | None:
        """Mean force over that of the reference load, in per cent."""
        return (
            None
            if self.reference is None
            else PER_CENT * (self.record.force / self.reference.force_n)
        )

    @property
    def time_difference_percent(self) -> float | None:
        """Time more than programmed, in per cent."""
        planned = self.row.planned
        return PER_CENT * (self.record.time / planned - 1.0) if planned else None


COLUMNS: tuple[Column[LoggedCut], ...] = (
    Column(key="workingstep", value=lambda cut: cut.row.name),
    Column(key="tool", value=lambda cut: cut.tool),
    Column(key="begin_s", value=lambda cut: cut.row.begin),
    Column(key="programmed_time_s", value=lambda cut: cut.row.planned),
    Column(key="time_s", value=lambda cut: cut.record.time),
    Column(key="cutting_time_s", value=lambda cut: cut.record.cutting_time),
    Column(key="time_difference_percent", value=lambda cut: cut.time_difference_percent),
    Column(key="greatest_power_w", value=lambda cut: cut.record.power),
    Column(key="mean_power_w", value=lambda cut: cut.record.mean_power),
    Column(
        key="reference_power_w",
        value=lambda cut: None if cut.reference is None else cut.reference.power_w,
    ),
    Column(key="mean_force_n", value=lambda cut: cut.record.force),
    Column(
        key="reference_force_n",
        value=lambda cut: None if cut.reference is None else cut.reference.force_n,
    ),
    Column(key="load_percent_of_reference", value=lambda cut: cut.load_percent),
    Column(
        key="least_override_percent", value=lambda cut: PER_CENT * cut.row.override_range[0]
    ),
    Column(key="mean_feed_mm_min", value=lambda cut: mm_min_from_speed(cut.record.feed)),
    Column(key="over_set_point_s", value=lambda cut: cut.record.over_time),
    Column(
        key="flank_wear_mm", value=lambda cut: None if cut.row.wear is None else cut.row.wear[0]
    ),
    Column(key="done", value=lambda cut: "; ".join(cut.done)),
)
"""LTIME, CTIME, TDIFF, PMAX, PREF, FMIN and OVLD of adaptive feed control, and the wear."""


def cuts(run: ControlRun) -> tuple[LoggedCut, ...]:
    """Return the cuts of a run, in order."""
    found = rows(run)
    begins = [*(row.begin for row in found[1:]), run.time + 1.0]
    pairs = zip(found, begins, strict=True)
    return tuple(_cut(run, row, end) for row, end in pairs if row.record.revolutions)


def _cut(run: ControlRun, row: ControlRow, end: float) -> LoggedCut:
    advice = next((each for each, record in run.steps if record is row.record), None)
    machine, material = run.machine.name, run.material.material.name
    key = None if advice is None else key_of(machine, material, advice)
    return LoggedCut(
        row=row,
        key=key,
        reference=None if key is None else run.loads.get(key),
        done=tuple(
            f"{ACTIONS[event.kind]} at {event.time:.2f} s"
            for event in run.events
            if event.kind in ACTIONS and row.begin <= event.time < end
        ),
    )


def cuts_csv(run: ControlRun) -> bytes:
    """Return the log of the cuts as a table."""
    text = StringIO()
    table = csv.writer(text, lineterminator="\n")
    found = records(COLUMNS, cuts(run))
    table.writerow([column.key for column in COLUMNS])
    table.writerows([_cell(value) for value in each.values()] for each in found)
    return text.getvalue().encode()


def _cell(value: object) -> str:
    if value is None:
        return ""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def taught_by(run: ControlRun, *, is_teaching: bool) -> dict[CutKey, ReferenceLoad]:
    """Return the reference loads that a run has taught; none if it was stopped.

    Parameters
    ----------
    is_teaching : bool
        Whether loads that are known are taught anew.
    """
    if run.is_stopped:
        return {}
    return {
        cut.key: load
        for cut in cuts(run)
        if cut.key is not None and (is_teaching or cut.reference is None)
        if (load := taught_load(cut.record)) is not None
    }


def loads_words(run: ControlRun) -> str:
    """Return how the cuts compare with their reference loads, as text; empty without any."""
    found = [cut for cut in cuts(run) if cut.load_percent is not None]
    return ", ".join(f"{cut.row.name} {cut.load_percent:.0f} %" for cut in found)
