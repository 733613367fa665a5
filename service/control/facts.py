"""Figures of a controlled run for table, page and JSON. Units mm, s, N."""

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
from stepnc_model.plurals import counted

STAYED = 0.1
"""Share of the cutting time above the set point from which the force counts as staying above;
less is due to entries and steps of depth, which no feedback can avoid."""

BLIND = 0.1
"""Largest acceptable share of a workingstep's time without a measured force."""

ALL = 0.995
"""Share of the time from which a reason is stated alone."""

MOST_REASONS = 3
"""Most reasons that are stated for a workingstep."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlRow:
    """Figures of a workingstep, of the run outside workingsteps, or of the whole run."""

    id: str | None
    """Id of the workingstep; None outside workingsteps."""
    begin: float
    """Start time in the run, in s."""
    planned: float
    """Planned time of the executed part at an override of 1, in s."""
    record: RunRecord
    holds: int = 0
    blind: float = 0.0
    """Time at feed without a measured force, in s."""
    bound: str = ""
    """Limit that sets the force set point; empty if there is none."""
    inhibition: str = ""
    """Reason why the feed override was locked; empty if it was not."""
    shares: tuple[tuple[str, float], ...] = ()
    """Reasons that limited the override, with their shares of the cutting time."""

    @property
    def name(self) -> str:
        """Name of the row in a table."""
        return "outside workingsteps" if self.id is None else self.id

    @property
    def set_point(self) -> float | None:
        """Set point, in N; None if the force is not bounded or nothing was cut."""
        return self.record.set_point if isfinite(self.record.set_point) else None

    @property
    def override_range(self) -> tuple[float, float]:
        """Smallest and largest override while cutting; 1 if nothing was cut."""
        record = self.record
        return (record.least, record.greatest) if isfinite(record.least) else (1.0, 1.0)

    @property
    def has_stayed_over(self) -> bool:
        """True if the force stayed above its set point."""
        record = self.record
        return record.over_time > STAYED * record.cutting_time

    @property
    def factor(self) -> tuple[float, float] | None:
        """Measured factor on k_c with its deviation per revolution; None with too few data."""
        ratio = self.record.ratio
        if ratio.readings < 2:
            return None
        mean = exp(ratio.log_mean)
        return mean, mean * ratio.log_deviation

    @property
    def wear(self) -> tuple[float, float] | None:
        """Estimated flank wear at the end with its deviation, in mm; None if not known."""
        life = self.record.life
        return None if life is None else (life.flank_wear, life.uncertainty)

    @property
    def why(self) -> str:
        """Reasons that limited the override, in a sentence."""
        if self.inhibition:
            return f"feed not controlled: {self.inhibition}"
        if not self.shares:
            return "no chips: nothing to control"
        override = f"override {100.0 * self.record.override:.0f} %"
        first, share = self.shares[0]
        if share > ALL:
            return f"{override}, limited by {first}"
        told = self.shares[:MOST_REASONS]
        words = ", ".join(f"{words} {_percent(share)}" for words, share in told)
        return f"{override}, limited by {words} of the cut"


def rows(run: ControlRun) -> tuple[ControlRow, ...]:
    """Return the rows of the workingsteps in order, and of the time outside if there is any."""
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
    """Return the totals of the run, without a k_c factor, which differs between tools."""
    total = RunRecord(workingstep=0)
    for _, record in run.steps:
        for name in _ADDED:
            setattr(total, name, getattr(total, name) + getattr(record, name))
        total.peak = max(total.peak, record.peak)
        total.power = max(total.power, record.power)
        total.longest_over = max(
            total.longest_over, record.longest_over, key=lambda each: each.seconds
        )
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
    "lost", "work", "astray",
)  # fmt: skip


def exceeded(run: ControlRun, rows: Sequence[ControlRow]) -> tuple[str, ...]:
    """Return a sentence for each fault of the run; none for a good run."""
    ends = {EventKind.STOP: "stopped", EventKind.LOST: "lost"}
    stops = [event for event in run.events if event.kind in ends]
    return (
        *(f"{ends[event.kind]} at {event.time:.2f} s: {event.text}" for event in stops),
        *(
            f"{row.name}: {row.record.over_time:.3g} s of {row.record.cutting_time:.3g} s with "
            f"chips above {EXCESS_RATIO:g} times the set point of {row.record.set_point:.4g} N"
            for row in rows
            if row.has_stayed_over
        ),
        *(
            f"{row.name}: {row.record.longest_over.seconds:.3g} s without a break above the "
            f"set point, at most {row.record.longest_over.most:.3g} times"
            for row in rows
            if row.record.longest_over.is_lasting
        ),
        *(
            f"{row.name}: the override was not followed for {row.record.astray:.3g} s"
            for row in rows
            if row.record.astray > 0.0
        ),
        *(
            f"{event.text} (at {event.time:.2f} s)"
            for event in run.events
            if event.kind is EventKind.WEAR
        ),
        *(
            f"{row.name}: no force for {row.blind:.3g} s of {row.record.time:.3g} s: run at "
            "the safe override"
            for row in rows
            if row.blind > BLIND * row.record.time
        ),
    )


def event_counts(run: ControlRun) -> str:
    """Return the number of events by kind, without starts of workingsteps."""
    counts: Counter[EventKind] = Counter(
        event.kind for event in run.events if event.kind is not EventKind.WORKINGSTEP
    )
    told = (f"{counts[kind]} {kind.value}" for kind in EventKind if counts[kind])
    return ", ".join(told) or "none"


def disturbed(run: ControlRun) -> tuple[tuple[str, bool], ...]:
    """Return each disturbance as requested, and whether the run reached its time."""
    return tuple((word, (time_of(word) or 0.0) <= run.time) for word in run.disturbances)


def disturbed_words(run: ControlRun) -> str:
    """Return the disturbances as text; those that the run never reached are marked."""
    told = (
        word if has_come else f"{word} (the run ended before)"
        for word, has_come in disturbed(run)
    )
    return ", ".join(told) or "nothing"


def law_words(run: ControlRun) -> str:
    """Return the name of the control law and its preview, or the recorded run."""
    if run.recorded:
        return f"none, recorded run {run.recorded}"
    if not run.has_preview:
        return run.law.value
    return f"{run.law.value} with preview of {counted(run.settings.look_ahead, 'revolution')}"


def mode_words(run: ControlRun) -> str:
    """Return the mode, and whether the operator changed it during the run."""
    was_switched = any(event.kind is EventKind.ORDER for event in run.events)
    return f"{run.criterion.value} at the end" if was_switched else run.criterion.value


def saved(run: ControlRun) -> str:
    """Return the time saved or lost against the programmed feed, as text."""
    if not run.progress:
        return "nothing was run"
    less = run.progress - run.time
    share = abs(less) / run.progress
    word = "shorter" if less >= 0.0 else "longer"
    return f"{abs(less):.1f} s {word} than {run.progress:.1f} s ({share:.1%})"


def _percent(share: float) -> str:
    return f"{100.0 * share:.0f} %" if share >= 0.005 else "< 1 %"
