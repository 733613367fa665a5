"""Grade of a group of outcomes against its plan.

The letter grades the prediction: the root mean square of the deviations, bias and scatter
together, of the quantity that deviates most. Roughness counts only above the plan. Two words
take precedence over letters: *violated*, the force exceeded its bound, and *wasted*, it stayed
far below although the plan intended to use it.
"""

from collections.abc import Mapping
from enum import StrEnum
from math import hypot

from kbe.bound import BoundUse
from kbe.statistics import DeviationStatistics, Evaluated

LETTERS = ((0.05, "A"), (0.10, "B"), (0.20, "C"))
"""Greatest root mean square deviation of each letter."""


class EvaluationGrade(StrEnum):
    """Grade of a group, from worst to best; unknown without data."""

    VIOLATED = "violated"
    WASTED = "wasted"
    D = "D"
    C = "C"
    B = "B"
    A = "A"
    UNKNOWN = "unknown"


def grade(
    deviations: Mapping[Evaluated, DeviationStatistics], bound: BoundUse
) -> EvaluationGrade:
    """Grade a group of outcomes.

    Parameters
    ----------
    deviations : mapping of DeviationStatistics
    bound : BoundUse
        A group is violated by one outcome, and wasted by half of its outcomes.
    """
    if bound.violated:
        return EvaluationGrade.VIOLATED
    if bound.wasted and 2 * bound.wasted >= bound.known:
        return EvaluationGrade.WASTED
    sizes = [_size(which, each) for which, each in deviations.items()]
    known = [size for size in sizes if size is not None]
    if not known:
        return EvaluationGrade.UNKNOWN
    worst = max(known)
    return next(
        (EvaluationGrade(letter) for most, letter in LETTERS if worst <= most),
        EvaluationGrade.D,
    )


def _size(which: Evaluated, statistics: DeviationStatistics) -> float | None:
    """Root mean square deviation of one quantity; None if nothing is known."""
    if statistics.mean is None:
        return None
    # A surface smoother than planned is not a defect.
    if which is Evaluated.ROUGHNESS and statistics.mean <= 0.0:
        return 0.0
    return hypot(statistics.mean, statistics.deviation or 0.0)
