"""Figures of a run under control for table, page and JSON. Units mm, s, N."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, isfinite

from controller.orders import EventKind
from controller.record import EXCESS_RATIO, RunRecord
from optimiser.advice import Advice
from service.control.disturbances import time_of
from service.control.holding import ends_of
from service.control.run import ControlRun

STAYED = 0.1
"""share of the time with chips above the set point from which the force stayed above it; less
are entries and steps of depth, which no feedback can avoid"""

BLIND = 0.1
"""share of the time of a workingstep that may go by without a force"""

ALL = 0.995
"""share of the time from which a reason is told alone"""

MOST_REASONS = 3
"""that are told of one workingstep"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlRow:
    """One workingstep, what stands before them all, or the whole run."""

    id: str | None
    """None: no workingstep"""
    begin: float
    """s of the run"""
    planned: float
    """s at an override of 1, of what was run of it"""
    record: RunRecord
    holds: int = 0
    blind: float = 0.0
    """s at feed without a force"""
    bound: str = ""
    """what the set point follows from; empty: there is none"""
    inhibition: str = ""
    """why the feed was locked"""
    shares: tuple[tuple[str, float], ...] = ()
    """what held the override, and for which share of the time with chips"""

    @property
    def name(self) -> str:
        """Name of the row in a table."""
        return "outside workingsteps" if self.id is None else self.id

    @property
    def set_point(self) -> float | None:
        """N; None: nothing bounds the force, or nothing was cut."""
        return self.record.set_point if isfinite(self.record.set_point) else None

    @property
    def override_range(self) -> tuple[float, float]:
        """Least and greatest with chips; 1 without."""
        record = self.record
        return (record.least, record.greatest) if isfinite(record.least) else (1.0, 1.0)

    @property
    def has_stayed_over(self) -> bool:
        """Whether the force stayed above its set point."""
        record = self.record
        return record.over_time > STAYED * record.cutting_time

    @property
    def factor(self) -> tuple[float, float] | None:
        """Factor on k_c as measured, and the deviation of one revolution; None: too few."""
        ratio = self.record.ratio
        if ratio.readings < 2:
            return None
        mean = exp(ratio.log_mean)
        return mean, mean * ratio.log_deviation

    @property
    def why(self) -> str:
        """Reasons that held the override, in a sentence."""
        if self.inhibition:
            return f"feed left as it is: {self.inhibition}"
        if not self.shares:
            return "no chips: nothing to control"
        override = f"override {100.0 * self.record.override:.0f} %"
        first, share = self.shares[0]
        if share > ALL:
            return f"{override}, held by {first}"
        told = self.shares[:MOST_REASONS]
        words = ", ".join(f"{words} {_percent(share)}" for words, share in told)
        return f"{override}, held by {words} of the cut"


def rows(run: ControlRun) -> tuple[ControlRow, ...]:
    """The run's workingsteps in their order; what is around them if it takes time."""
    found, left = [], run.progress
    for advice, record in run.steps:
        planned = min(run.planned[record.workingstep].time, left)
        left -= planned
        if advice is not None or record.time > 0.0:
            found.append(_row(run, advice, record, planned))
    return tuple(found)


def _row(
    run: ControlRun, advice: Advice | None, record: RunRecord, planned: float
) -> ControlRow:
    held = run.held[record.workingstep]
    ends = None if advice is None else ends_of(advice)
    return ControlRow(
        id=_id(advice, record),
        begin=held.begin,
        planned=planned,
        record=record,
        holds=held.holds,
        blind=held.blind,
        bound="" if ends is None else ends.force_bound(run.settings),
        inhibition="" if ends is None else ends.reference.inhibition,
        shares=held.shares,
    )


def _id(advice: Advice | None, record: RunRecord) -> str | None:
    if advice is not None:
        return advice.workingstep.id
    return f"workingstep {record.workingstep}" if record.workingstep else None


def whole(run: ControlRun) -> ControlRow:
    """All of it, without a factor on k_c: each tool has its own."""
    total = RunRecord(workingstep=0)
    for _, record in run.steps:
        for name in _ADDED:
            setattr(total, name, getattr(total, name) + getattr(record, name))
        total.peak = max(total.peak, record.peak)
        total.least = min(total.least, record.least)
        total.greatest = max(total.greatest, record.greatest)
    held = run.held.values()
    return ControlRow(
        id="total",
        begin=0.0,
        planned=run.progress,
        record=total,
        holds=sum(each.holds for each in held),
    )


_ADDED = (
    "time", "cutting_time", "way", "impulse", "excess", "over_time", "overrides", "revolutions",
    "lost",
)  # fmt: skip


def exceeded(run: ControlRun, found: Sequence[ControlRow]) -> tuple[str, ...]:
    """A sentence for each thing that makes the run a failure; none: it is good."""
    ends = {EventKind.STOP: "stopped", EventKind.LOST: "lost"}
    stops = [event for event in run.events if event.kind in ends]
    return (
        *(f"{ends[event.kind]} at {event.time:.2f} s: {event.text}" for event in stops),
        *(
            f"{row.name}: {row.record.over_time:.3g} s of {row.record.cutting_time:.3g} s with "
            f"chips above {EXCESS_RATIO:g} times the set point of {row.record.set_point:.4g} N"
            for row in found
            if row.has_stayed_over
        ),
        *(
            f"{row.name}: no force for {row.blind:.3g} s of {row.record.time:.3g} s: run at "
            "the safe override"
            for row in found
            if row.blind > BLIND * row.record.time
        ),
    )


def event_counts(run: ControlRun) -> str:
    """Number of events by kind, without the beginnings of workingsteps."""
    counts: Counter[EventKind] = Counter(
        event.kind for event in run.events if event.kind is not EventKind.WORKINGSTEP
    )
    told = (f"{counts[kind]} {kind.value}" for kind in EventKind if counts[kind])
    return ", ".join(told) or "none"


def disturbed(run: ControlRun) -> tuple[tuple[str, bool], ...]:
    """Each disturbance as it was asked for, and whether the run has come to it."""
    return tuple((word, (time_of(word) or 0.0) <= run.time) for word in run.disturbances)


def disturbed_words(run: ControlRun) -> str:
    """The disturbances as a list; those that never came are told as such."""
    told = (
        word if has_come else f"{word} (the run ended before)"
        for word, has_come in disturbed(run)
    )
    return ", ".join(told) or "nothing"


def law_words(run: ControlRun) -> str:
    """The law and what it knew."""
    if not run.has_preview:
        return run.law.value
    return f"{run.law.value} with preview of {run.settings.look_ahead} revolutions"


def mode_words(run: ControlRun) -> str:
    """The mode, and whether the operator has chosen it on the way."""
    was_switched = any(event.kind is EventKind.ORDER for event in run.events)
    return f"{run.criterion.value} at the end" if was_switched else run.criterion.value


def saved(run: ControlRun) -> str:
    """Time against that of the same part of the program at its own feed."""
    if not run.progress:
        return "nothing was run"
    less = run.progress - run.time
    share = abs(less) / run.progress
    word = "shorter" if less >= 0.0 else "longer"
    return f"{abs(less):.1f} s {word} than {run.progress:.1f} s ({share:.1%})"


def _percent(share: float) -> str:
    return f"{100.0 * share:.0f} %" if share >= 0.005 else "< 1 %"
