"""Adaptive warning thresholds of the cutting force.

The usual force of a steady cut is learnt as mean and variance of ln F, with exponentially
decaying weights. A force far above it is a warning even while it is below the set point; a
force above the set point by a margin is over it, learnt or not: the "safe limit" and "over
limit" of [1]_. Units: N.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, "Process monitoring and control".
.. [2] T. Finch, "Incremental calculation of weighted mean and variance", University of
   Cambridge, 2009: exponentially weighted mean and standard deviation.
"""

from dataclasses import dataclass
from enum import StrEnum
from math import exp, log, sqrt
from typing import NamedTuple

from controller.signals.signal import Revolution
from simulator.physics.domain import require_positive
from stepnc_model.tuples import quick_replace


class AlarmLevel(StrEnum):
    """Alarm level of the force relative to its bound."""

    SAFE = "safe"
    WARNING = "warning"
    """Force far above its usual value in this cut, and not far below the set point."""
    OVER = "over"
    """Force above the set point by a margin."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Thresholds:
    """Settings of the force warning thresholds.

    Raises
    ------
    ValueError
        If a number is not positive, or the learning period is shorter than two revolutions.
    """

    deviations: float = 5.0
    """Standard deviations k of ln F above its mean that cause a warning.

    With the learning below, white noise warns once in some ten thousand revolutions, and only
    above the share of the set point.
    """
    share: float = 0.8
    """Share of the set point below which there is no warning."""
    margin: float = 0.2
    """Share of the set point by which a force must exceed it to count as over it."""
    memory: int = 50
    """Number of revolutions after which a revolution is weighted 1/e."""
    learning: int = 20
    """Number of revolutions until the learnt mean is used."""
    least_deviation: float = 0.02
    """Least standard deviation of ln F, so that a noise-free force does not cause warnings."""

    def __post_init__(self) -> None:
        for name in ("deviations", "share", "margin", "least_deviation"):
            require_positive(getattr(self, name), name.replace("_", " "), "")
        if min(self.memory, self.learning) < 2:
            raise ValueError("memory and learning must be at least 2 revolutions")


USUAL = Thresholds()


@quick_replace
class ThresholdWatch(NamedTuple):
    """Learnt force threshold and the present alarm level; a new object learns anew."""

    level: AlarmLevel = AlarmLevel.SAFE
    log_mean: float = 0.0
    """Learnt mean of ln(F / 1 N)."""
    log_variance: float = 0.0
    revolutions: int = 0
    """Number of revolutions learnt from so far."""
    workingstep: int = 0
    """Number of the workingstep to which they belong."""

    def threshold(self, by: Thresholds = USUAL) -> float | None:
        """Force above which it is unusual, N; None before it is learnt."""
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
    """Update the force watch with one more revolution.

    Another workingstep is learnt anew; for any other known change, above all entry into the
    work, pass a new ``ThresholdWatch()``. An unusual revolution counts as if it were at the
    threshold: a lasting change is learnt in the end, a passing one has little effect.

    Parameters
    ----------
    revolution : Revolution
        Without a mean force above 0 it changes nothing.
    set_point : float, N
        Above 0.
    is_steady : bool
        Whether depth and feed are those of the previous revolutions. If not, nothing is learnt
        and only the set point counts.

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
        return watch._replace(level=AlarmLevel.OVER if is_above else AlarmLevel.SAFE)
    level = _level(watch, force, set_point=set_point, by=by)
    return _learnt(watch, log(force), by)._replace(level=level)


def reason(
    watch: ThresholdWatch,
    level: AlarmLevel,
    force: float,
    *,
    set_point: float,
    by: Thresholds = USUAL,
) -> str:
    """Sentence on the alarm level of a force, with its numbers, as used in warnings.

    Parameters
    ----------
    watch : ThresholdWatch
        State before the revolution of that force.
    force : float, N
    set_point : float, N

    Examples
    --------
    >>> reason(ThresholdWatch(), AlarmLevel.OVER, 492.0, set_point=400.0)
    'force 1.23 times the set point of 400 N: 492 N, limit 1.2 times'
    """
    threshold = watch.threshold(by)
    if level is AlarmLevel.WARNING and threshold is not None:
        mean = exp(watch.log_mean)
        count = min(watch.revolutions, by.memory)
        return (
            f"force {force / mean:.3g} times the mean of the last {count} revolutions: "
            f"{force:.4g} N, limit {threshold / mean:.3g} times"
        )
    if level is AlarmLevel.OVER:
        return (
            f"force {force / set_point:.3g} times the set point of {set_point:.4g} N: "
            f"{force:.4g} N, limit {1.0 + by.margin:.3g} times"
        )
    return f"force {force:.4g} N, {force / set_point:.3g} times the set point"


def _level(
    watch: ThresholdWatch, force: float, *, set_point: float, by: Thresholds
) -> AlarmLevel:
    """Alarm level of a force in a steady cut, before the force is learnt."""
    if force > (1.0 + by.margin) * set_point:
        return AlarmLevel.OVER
    threshold = watch.threshold(by)
    if threshold is not None and force > max(threshold, by.share * set_point):
        return AlarmLevel.WARNING
    return AlarmLevel.SAFE


def _learnt(watch: ThresholdWatch, value: float, by: Thresholds) -> ThresholdWatch:
    """Update mean and variance with one more value, [2]_; plain until memory is full."""
    count = watch.revolutions + 1
    away = value - watch.log_mean if watch.revolutions else 0.0
    if watch.revolutions >= by.learning:
        reach = _reach(watch, by)
        away = min(max(away, -reach), reach)
    part = max(1.0 / count, 1.0 / by.memory)
    return watch._replace(
        log_mean=watch.log_mean + part * away if watch.revolutions else value,
        log_variance=(1.0 - part) * (watch.log_variance + part * away * away),
        revolutions=count,
    )


def _reach(watch: ThresholdWatch, by: Thresholds) -> float:
    """Distance of the threshold above the mean, in ln F."""
    return by.deviations * max(sqrt(watch.log_variance), by.least_deviation)
