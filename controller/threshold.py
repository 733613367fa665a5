"""Moving thresholds of the cutting force, and the warning that the paper's stage three gives.

What a steady cut takes is learnt as mean and variance of ln F, each revolution counting less
the older it is. A force far above it is a warning even while it is below the set point; above
the set point by a margin it is over, learnt or not: the "safe limit" and "over limit" of [1]_.
Units N.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, "Process monitoring and control".
.. [2] T. Finch, "Incremental calculation of weighted mean and variance", University of
   Cambridge, 2009: exponentially weighted mean and standard deviation.
"""

from dataclasses import dataclass, replace
from enum import StrEnum
from math import exp, log, sqrt

from controller.signal import Revolution
from simulator.physics.domain import require_positive


class AlarmLevel(StrEnum):
    """Level of the force relative to its bound."""

    SAFE = "safe"
    WARNING = "warning"
    """far above what this cut took until now, and not far below the set point"""
    OVER = "over"
    """above the set point by a margin"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Thresholds:
    """Settings of the warning thresholds.

    Raises
    ------
    ValueError
        If a number is not positive, or a mean is to be learnt from one revolution.
    """

    deviations: float = 5.0
    """k, standard deviations of ln F above its mean; with the learning below, white noise
    warns once in some ten thousand revolutions, and only above the share of the set point"""
    share: float = 0.8
    """of the set point: below it, nothing is warned of"""
    margin: float = 0.2
    """by which the force is over the set point, as a share of it"""
    memory: int = 50
    """revolutions after which one counts 1/e"""
    learning: int = 20
    """revolutions until the mean is trusted"""
    least_deviation: float = 0.02
    """of ln F: a force without noise is no reason to warn of every trifle"""

    def __post_init__(self) -> None:
        for name in ("deviations", "share", "margin", "least_deviation"):
            require_positive(getattr(self, name), name.replace("_", " "), "")
        if min(self.memory, self.learning) < 2:
            raise ValueError("memory and learning must be at least 2 revolutions")


USUAL = Thresholds()


@dataclass(frozen=True, slots=True, kw_only=True)
class ThresholdWatch:
    """Learnt threshold and the level. A new one learns anew."""

    level: AlarmLevel = AlarmLevel.SAFE
    log_mean: float = 0.0
    """of ln(F / 1 N)"""
    log_variance: float = 0.0
    revolutions: int = 0
    """that were learnt from"""
    workingstep: int = 0
    """that they belong to"""

    def threshold(self, by: Thresholds = USUAL) -> float | None:
        """Force in N above which it is out of the ordinary; None: not learnt yet."""
        if self.revolutions < by.learning:
            return None
        return exp(self.log_mean + _reach(self, by))


def watched(
    watch: ThresholdWatch,
    revolution: Revolution,
    *,
    set_point: float,
    is_steady: bool = True,
    by: Thresholds = USUAL,
) -> ThresholdWatch:
    """The watch after one more revolution.

    Another workingstep is learnt anew; for any other change that is known of, entry into the
    work above all, pass a new ``ThresholdWatch()``. A revolution that is out of the ordinary
    counts as if it lay at the threshold: what stays is learnt in the end, what passes teaches
    little.

    Parameters
    ----------
    watch : ThresholdWatch
    revolution : Revolution
        Without a mean force, or with none above 0, it changes nothing.
    set_point : float, N
        Above 0.
    is_steady : bool
        Whether depth and feed are those of the revolutions before. While they are not, nothing
        is learnt and only the set point counts.
    by : Thresholds

    Raises
    ------
    ValueError
        If the set point is not positive.
    """
    require_positive(set_point, "set point", "N")
    if watch.workingstep != revolution.workingstep:
        watch = ThresholdWatch(workingstep=revolution.workingstep)
    force = revolution.force
    if not force > 0.0:
        return watch
    if not is_steady:
        is_above = force > (1.0 + by.margin) * set_point
        return replace(watch, level=AlarmLevel.OVER if is_above else AlarmLevel.SAFE)
    level = _level(watch, force, set_point=set_point, by=by)
    return replace(_learnt(watch, log(force), by), level=level)


def reason(
    watch: ThresholdWatch,
    level: AlarmLevel,
    force: float,
    *,
    set_point: float,
    by: Thresholds = USUAL,
) -> str:
    """Reason of a force's level, with its numbers: the words of every warning.

    Parameters
    ----------
    watch : ThresholdWatch
        Before the revolution of that force.
    level : AlarmLevel
    force : float, N
    set_point : float, N
    by : Thresholds

    Examples
    --------
    >>> reason(ThresholdWatch(), AlarmLevel.OVER, 492.0, set_point=400.0)
    'force 1.23 times the set point of 400 N: 492 N, from 1.2 times on'
    """
    threshold = watch.threshold(by)
    if level is AlarmLevel.WARNING and threshold is not None:
        mean = exp(watch.log_mean)
        count = min(watch.revolutions, by.memory)
        return (
            f"force {force / mean:.3g} times the mean of the last {count} revolutions: "
            f"{force:.4g} N, from {threshold / mean:.3g} times on"
        )
    if level is AlarmLevel.OVER:
        return (
            f"force {force / set_point:.3g} times the set point of {set_point:.4g} N: "
            f"{force:.4g} N, from {1.0 + by.margin:.3g} times on"
        )
    return f"force {force:.4g} N, {force / set_point:.3g} times the set point"


def _level(
    watch: ThresholdWatch, force: float, *, set_point: float, by: Thresholds
) -> AlarmLevel:
    """Level of a force in a steady cut, before it is learnt."""
    if force > (1.0 + by.margin) * set_point:
        return AlarmLevel.OVER
    threshold = watch.threshold(by)
    if threshold is not None and force > max(threshold, by.share * set_point):
        return AlarmLevel.WARNING
    return AlarmLevel.SAFE


def _learnt(watch: ThresholdWatch, value: float, by: Thresholds) -> ThresholdWatch:
    """Mean and variance with one more value, [2]_; the plain ones until the memory is full."""
    count = watch.revolutions + 1
    away = value - watch.log_mean if watch.revolutions else 0.0
    if watch.revolutions >= by.learning:
        reach = _reach(watch, by)
        away = min(max(away, -reach), reach)
    part = max(1.0 / count, 1.0 / by.memory)
    return replace(
        watch,
        log_mean=watch.log_mean + part * away if watch.revolutions else value,
        log_variance=(1.0 - part) * (watch.log_variance + part * away * away),
        revolutions=count,
    )


def _reach(watch: ThresholdWatch, by: Thresholds) -> float:
    """Of the threshold above the mean, in ln F."""
    return by.deviations * max(sqrt(watch.log_variance), by.least_deviation)
