"""One side of a row of the evaluation table: roughing or finishing with one tool.

Columns are those of [1]_, Table 1, for one operation; numbers are means over its outcomes,
names are all that occurred. Beyond [1]_: deviations, trends, grade, remarks and factor.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, Table 1.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime

from kbe.bound import BoundUse, used
from kbe.factor import FactorInterval, interval
from kbe.grade import EvaluationGrade, grade
from kbe.moments import Moments
from kbe.remarks import Evidence, Remark, is_pending, remarks
from kbe.statistics import DeviationStatistics, DeviationTally, Evaluated, quantity_of
from stepnc_model.entities.optimisation import FaceMillingImmersion
from stepnc_model.outcome import Context, EvaluatedQuantity, LearnedCorrection, ProcessOutcome

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
