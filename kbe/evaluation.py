"""Evaluation table of [1]_ (Table 1): results of machining, feature by feature.

A row is a feature on a machine in a material, with its roughing and its finishing side. Sides
are kept by tool; a roughing and a finishing tool used on the same feature in the same run share
a row. So a side that was paired with two of the other kind is in two rows, and an unpaired side
has a row of its own.

Outcomes are read once. The memory needed is bounded for each side (moments, and samples for the
quantiles), whatever the number of outcomes.

One side of a row of the evaluation table: roughing or finishing with one tool.

Columns are those of [1]_, Table 1, for one operation; numbers are means over its outcomes,
names are all that occurred. Beyond [1]_: deviations, trends, grade, remarks and factor.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, Table 1.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum

from kbe.factor import FactorInterval, interval
from kbe.remarks import (
    BoundUse,
    EvaluationGrade,
    Evidence,
    Remark,
    grade,
    is_pending,
    remarks,
    used,
)
from kbe.statistics import DeviationStatistics, DeviationTally, Evaluated, Moments, quantity_of
from stepnc_model.entities.optimisation import FaceMillingImmersion
from stepnc_model.outcome import (
    Context,
    EvaluatedQuantity,
    FeatureFacts,
    LearnedCorrection,
    ProcessOutcome,
)

TYPES = {
    FaceMillingImmersion.FULL_IMMERSION: "d_s1",
    FaceMillingImmersion.UNIDIRECTIONAL_PART_IMMERSION: "d_s2",
    FaceMillingImmersion.BILATERAL_PART_IMMERSION: "d_s3",
}
"""Symbols of the types of face milling in [1]_."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Knowledge:
    """Proposed and accepted corrections by context, for an evaluation table."""

    proposed: Mapping[Context, LearnedCorrection] = field(default_factory=dict)
    accepted: Mapping[Context, LearnedCorrection] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Side:
    """Evaluated outcomes of roughing or finishing with one tool."""

    context: Context
    specific_force: float | None
    """k_c1.1 of the catalogue, N/mm²."""
    cutting_speed: float | None
    """Cutting speed V_c, mm/s."""
    step_depth: EvaluatedQuantity
    """Depth of one pass a_s, mm: predicted and evaluated."""
    feed_per_tooth: EvaluatedQuantity
    """Feed per tooth f_z, mm: predicted and evaluated."""
    immersions: tuple[FaceMillingImmersion, ...]
    strategies: tuple[str, ...]
    modes: tuple[str, ...]
    outcomes: int
    runs: int
    latest: datetime
    deviations: Mapping[Evaluated, DeviationStatistics]
    bound: BoundUse
    grade: EvaluationGrade
    remarks: tuple[Remark, ...]
    factor: FactorInterval | None
    """Learned factor on k_c; None if nothing was learned."""
    is_pending: bool
    """Whether the learned factor differs notably from the one that plans use."""


class SideTally:
    """Accumulator of the outcomes of one side, in the order of time (mutable state)."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._specific_force, self._cutting_speed = Moments(), Moments()
        self._step_depth, self._feed_per_tooth = QuantityTally(), QuantityTally()
        self._immersions: set[FaceMillingImmersion] = set()
        self._strategies: set[str] = set()
        self._modes: set[str] = set()
        self._deviations = {which: DeviationTally() for which in Evaluated}
        self._bound = BoundUse()
        self._count = self._runs = 0
        self._run: str | None = None
        self._latest: datetime | None = None

    def add(self, outcome: ProcessOutcome) -> None:
        """Add one more outcome of this side.

        Raises
        ------
        ValueError
            If it is older than the previous one.
        """
        if self._latest is not None and outcome.recorded_at < self._latest:
            raise ValueError(
                f"outcome of run {outcome.run} at {outcome.recorded_at} is older than the one "
                f"before, at {self._latest}"
            )
        self._latest = outcome.recorded_at
        self._count += 1
        # Runs on one machine follow one another.
        self._runs += outcome.run != self._run
        self._run = outcome.run
        self._facts(outcome)
        for which, tally in self._deviations.items():
            tally.add(quantity_of(outcome, which).deviation, run=self._runs)
        self._bound = used(self._bound, outcome)

    def side(self, knowledge: Knowledge) -> Side:
        """Evaluate the outcomes so far; at least one is required."""
        if self._latest is None:
            raise ValueError("a side needs at least one outcome")
        deviations = {which: each.statistics() for which, each in self._deviations.items()}
        proposed = knowledge.proposed.get(self._context)
        evidence = Evidence(
            deviations=deviations,
            bound=self._bound,
            proposed=proposed,
            accepted=knowledge.accepted.get(self._context),
        )
        return Side(
            context=self._context,
            specific_force=_mean(self._specific_force),
            cutting_speed=_mean(self._cutting_speed),
            step_depth=self._step_depth.quantity(),
            feed_per_tooth=self._feed_per_tooth.quantity(),
            immersions=tuple(sorted(self._immersions)),
            strategies=tuple(sorted(self._strategies)),
            modes=tuple(sorted(self._modes)),
            outcomes=self._count,
            runs=self._runs,
            latest=self._latest,
            deviations=deviations,
            bound=self._bound,
            grade=grade(deviations, self._bound),
            remarks=remarks(evidence),
            factor=None if proposed is None else interval(proposed),
            is_pending=is_pending(evidence),
        )

    def _facts(self, outcome: ProcessOutcome) -> None:
        """Add the values that are not deviations."""
        _add(self._specific_force, outcome.specific_force)
        _add(self._cutting_speed, outcome.cutting_speed)
        self._step_depth.add(outcome.step_depth)
        self._feed_per_tooth.add(outcome.feed_per_tooth)
        if outcome.immersion is not None:
            self._immersions.add(outcome.immersion)
        if outcome.strategy:
            self._strategies.add(outcome.strategy)
        self._modes.add(outcome.mode)


class QuantityTally:
    """Accumulator of a quantity as planned and as measured (mutable state).

    Where some outcomes have both values, the means are of those only.
    """

    def __init__(self) -> None:
        self._paired = (Moments(), Moments())
        self._single = (Moments(), Moments())

    def add(self, quantity: EvaluatedQuantity) -> None:
        """Add one more outcome of the quantity."""
        values = (quantity.predicted, quantity.measured)
        into = self._single if None in values else self._paired
        for moments, value in zip(into, values, strict=True):
            _add(moments, value)

    def quantity(self) -> EvaluatedQuantity:
        """Means of the planned and the measured values."""
        predicted, measured = self._paired if self._paired[0].count else self._single
        return EvaluatedQuantity(predicted=_mean(predicted), measured=_mean(measured))


def _add(moments: Moments, value: float | None) -> None:
    """Add a value to moments if it is known."""
    if value is not None:
        moments.add(0.0, value)


def _mean(moments: Moments) -> float | None:
    """Mean of the values; None without values."""
    return moments.mean if moments.count else None


class Grouping(StrEnum):
    """Grouping of outcomes into the rows of the table."""

    FEATURE = "feature"
    """One row for each feature of each program."""
    KIND = "kind"
    """One row for all features of a kind, of all programs."""


class RowFilter(StrEnum):
    """Filter of rows that have at least one side with a property."""

    ALL = "all"
    VIOLATED = "violated"
    WASTED = "wasted"
    WITH_REMARKS = "with remarks"
    WITH_TREND = "with trend"
    FACTOR_PENDING = "factor pending"


class SortKey(StrEnum):
    """Order of the rows; ties are sorted by machine, feature, material and tools."""

    NAME = "name"
    GRADE = "grade"
    """Worst grade first."""
    RUNS = "runs"
    """Most runs first."""
    LATEST = "latest"
    """Newest outcome first."""
    FORCE = "force"
    """Greatest mean deviation first, up or down; likewise for time, feed and roughness."""
    TIME = "time"
    FEED = "feed"
    ROUGHNESS = "roughness"
    TIME_TO_WIN = "time to win"
    """Greatest possible saving of time first."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GroupKey:
    """Common attributes of the outcomes of a row."""

    machine: str
    program: str
    """Name of the program; empty when features are grouped by kind."""
    feature: str
    """Id of the feature, or its kind."""
    material: str

    @property
    def names(self) -> tuple[str, str, str, str]:
        """Attributes by which rows are sorted."""
        return self.machine, self.program, self.feature, self.material


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluationRow:
    """Row of the evaluation table, with at least one side."""

    key: GroupKey
    kind: str
    """EXPRESS name of the feature."""
    length: float | None
    """Length L of the feature, mm; None: not known, or not the same in all outcomes."""
    width: float | None
    """Width X of the feature, mm; None as for the length."""
    total_depth: float | None
    """Total depth a_t, mm; None as for the length."""
    roughing: Side | None
    finishing: Side | None

    @property
    def sides(self) -> tuple[Side, ...]:
        """Roughing and finishing side, as far as the row has them."""
        return tuple(side for side in (self.roughing, self.finishing) if side is not None)

    @property
    def grade(self) -> EvaluationGrade:
        """Worst grade of the sides of the row."""
        return min((side.grade for side in self.sides), key=list(EvaluationGrade).index)


@dataclass(frozen=True, slots=True, kw_only=True)
class _SideKey:
    """Key of a side within a group: finishing or roughing, and the tool."""

    is_finishing: bool
    tool: str


_Pair = tuple[_SideKey | None, _SideKey | None]
"""Roughing and finishing side of one row."""


class _Group:
    """Sides of one group, and which of them were used together (mutable state)."""

    def __init__(self, feature: FeatureFacts) -> None:
        self._feature = feature
        self._sides: dict[_SideKey, SideTally] = {}
        self._pairs: set[_Pair] = set()
        self._run: str | None = None
        self._met: dict[str, set[_SideKey]] = {}
        """Sides seen at each feature in the current run."""

    def add(self, outcome: ProcessOutcome) -> None:
        """Add one more outcome to the group."""
        self._feature = _common(self._feature, outcome.feature)
        key = _SideKey(is_finishing=outcome.is_finishing, tool=outcome.context.tool)
        self._sides.setdefault(key, SideTally(outcome.context)).add(outcome)
        if outcome.run != self._run:
            self._run, self._met = outcome.run, {}
        met = self._met.setdefault(outcome.feature.id, set())
        met.add(key)
        self._pairs |= {
            (rough, fine)
            for rough in met
            for fine in met
            if fine.is_finishing and not rough.is_finishing
        }

    def rows(self, key: GroupKey, knowledge: Knowledge) -> Iterator[EvaluationRow]:
        """Rows of the group: pairs first, then unpaired sides, sorted by tool."""
        sides = {which: tally.side(knowledge) for which, tally in self._sides.items()}
        for rough, fine in sorted(self._pairs | self._alone(), key=_tools):
            yield EvaluationRow(
                key=key,
                kind=self._feature.kind,
                length=self._feature.length,
                width=self._feature.width,
                total_depth=self._feature.total_depth,
                roughing=sides[rough] if rough else None,
                finishing=sides[fine] if fine else None,
            )

    def _alone(self) -> set[_Pair]:
        """Sides without a partner of the other kind."""
        paired = {key for pair in self._pairs for key in pair}
        return {
            (None, key) if key.is_finishing else (key, None)
            for key in self._sides
            if key not in paired
        }


def _tools(pair: _Pair) -> tuple[str, str]:
    """Sort key of the rows of a group: the tools."""
    rough, fine = pair
    return rough.tool if rough else "", fine.tool if fine else ""


def evaluation(
    outcomes: Iterable[ProcessOutcome],
    *,
    grouping: Grouping = Grouping.FEATURE,
    knowledge: Knowledge | None = None,
) -> tuple[EvaluationRow, ...]:
    """Build the evaluation table, ordered by names.

    Parameters
    ----------
    outcomes : iterable of ProcessOutcome
        In the order of time for each machine; iterated once.
    knowledge : Knowledge, optional
        Corrections to show and to compare; omitted: none.

    Raises
    ------
    ValueError
        If an outcome is older than the previous one on the same side of a row.
    """
    groups: dict[GroupKey, _Group] = {}
    for outcome in outcomes:
        key = _key(outcome, grouping)
        groups.setdefault(key, _Group(outcome.feature)).add(outcome)
    known = knowledge or Knowledge()
    return tuple(
        row
        for key in sorted(groups, key=lambda each: each.names)
        for row in groups[key].rows(key, known)
    )


def selected(rows: Iterable[EvaluationRow], keep: RowFilter) -> tuple[EvaluationRow, ...]:
    """Rows with at least one side that passes the filter, in their order."""
    return tuple(row for row in rows if any(map(_FILTERS[keep], row.sides)))


def ordered(rows: Sequence[EvaluationRow], by: SortKey) -> tuple[EvaluationRow, ...]:
    """Evaluation rows sorted by a key."""
    return tuple(sorted(sorted(rows, key=_names), key=_KEYS[by]))


def _key(outcome: ProcessOutcome, grouping: Grouping) -> GroupKey:
    """Group key of an outcome."""
    by_kind = grouping is Grouping.KIND
    return GroupKey(
        machine=outcome.context.machine,
        program="" if by_kind else outcome.program,
        feature=outcome.feature.kind if by_kind else outcome.feature.id,
        material=outcome.context.material,
    )


def _common(first: FeatureFacts, second: FeatureFacts) -> FeatureFacts:
    """Facts that are equal for two features; others are empty."""
    if first == second:
        return first
    return FeatureFacts(
        id=first.id if first.id == second.id else "",
        kind=first.kind if first.kind == second.kind else "",
        length=first.length if first.length == second.length else None,
        width=first.width if first.width == second.width else None,
        total_depth=first.total_depth if first.total_depth == second.total_depth else None,
    )


def _names(row: EvaluationRow) -> tuple[str, ...]:
    """Sort key: machine, program, feature, material, tools."""
    tools = (side.context.tool if side else "" for side in (row.roughing, row.finishing))
    return *row.key.names, *tools


def _has_trend(side: Side) -> bool:
    """True if any quantity of a side has a significant trend."""
    trends = (each.trend for each in side.deviations.values())
    return any(trend is not None and trend.is_significant for trend in trends)


_FILTERS: Mapping[RowFilter, Callable[[Side], bool]] = {
    RowFilter.ALL: lambda _: True,
    RowFilter.VIOLATED: lambda side: side.grade is EvaluationGrade.VIOLATED,
    RowFilter.WASTED: lambda side: side.grade is EvaluationGrade.WASTED,
    RowFilter.WITH_REMARKS: lambda side: bool(side.remarks),
    RowFilter.WITH_TREND: _has_trend,
    RowFilter.FACTOR_PENDING: lambda side: side.is_pending,
}


def _largest(which: Evaluated) -> Callable[[EvaluationRow], float]:
    """Sort key for the greatest mean deviation first; rows without one come last."""

    def key(row: EvaluationRow) -> float:
        means = (side.deviations[which].mean for side in row.sides)
        return -max((abs(mean) for mean in means if mean is not None), default=-1.0)

    return key


def _age(row: EvaluationRow) -> float:
    """Sort key for the newest outcome first."""
    latest: datetime = max(side.latest for side in row.sides)
    return -latest.timestamp()


_KEYS: Mapping[SortKey, Callable[[EvaluationRow], float]] = {
    SortKey.NAME: lambda _: 0.0,
    SortKey.GRADE: lambda row: list(EvaluationGrade).index(row.grade),
    SortKey.RUNS: lambda row: -max(side.runs for side in row.sides),
    SortKey.LATEST: _age,
    SortKey.FORCE: _largest(Evaluated.FORCE),
    SortKey.TIME: _largest(Evaluated.TIME),
    SortKey.FEED: _largest(Evaluated.FEED),
    SortKey.ROUGHNESS: _largest(Evaluated.ROUGHNESS),
    SortKey.TIME_TO_WIN: lambda row: -sum(side.bound.time_to_win for side in row.sides),
}
