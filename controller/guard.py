"""The guard between any law and the machine: what a law wants is only a wish.

It promises that the mean force of a tooth period stays below the breakage force, whatever the
law does, when

- where the cutter enters the work at an override of 1, the tooth that takes most stays below
  the breakage force over the sudden ratio: the planner's promise, with what the work hides. The
  air before must last until the feed has come down to 1; otherwise it must hold at the ceiling;
- at a given feed the force rises no more than by the sudden ratio from one revolution to the
  next ones, once within the time in which the feed follows;
- the sensors show the force within a fraction of a tooth period, or are known to be silent. The
  power of a main drive does not: it comes late.

The threshold is the breakage force over the sudden ratio, or 1.5 times the set point where that
is less. The override is held so low that the force measured now would stay below it, and the
feed is held within one tooth period when a tooth passes it. Against the set point, a tooth
counts as what it takes more than usual (:mod:`controller.overload`), against the breakage
force as what it takes. Where the program inhibits the override there is no promise. Units s, N.
"""

from dataclasses import dataclass
from enum import StrEnum
from math import inf, isfinite

from controller.reference import Reference

OVERLOAD_RATIO = 1.5
"""of the set point, at which the feed is held"""

SUDDEN_RATIO = 2.0
"""by which the force may rise at once at the same feed: the depth of a second pass"""

MARGIN = 0.95
"""of the threshold that the override is held to: noise of the measured force"""

RESUMED = 0.8
"""of the set point, aimed at after a hold"""

AIMED = 0.8
"""of the breakage force over the sudden ratio, that a set point is at most: a law that keeps it
must not meet the threshold by noise"""

LEAST_RESUMED = 0.02
"""override after a hold: a force far beyond all is a fault, and the feed must not crawl"""

NOTICED = 1e-3
"""of the threshold, below which a force bounds no override"""


class OverrideReason(StrEnum):
    """Why the law does not have its way."""

    NOTHING = "nothing"
    BAND = "override band"
    RATE = "rate limit"
    FORCE = "force guard"
    OVERLOAD = "overload"
    SILENCE = "no force reading"
    OFF = "switched off"
    INHIBITED = "the program inhibits the override"
    STOPPED = "stopped"


@dataclass(frozen=True, slots=True, kw_only=True)
class OverrideBand:
    """Within which the override may move.

    Raises
    ------
    ValueError
        When it is empty or its numbers are beyond their bounds.
    """

    floor: float = 0.2
    ceiling: float = 1.2
    rise: float = 0.25
    """greatest rise in one revolution, as a share; falling is free: it is the safe side"""
    safe: float = 0.5
    """override without force readings"""
    sensor_timeout: float = 0.5
    """s without a reading after which it holds"""
    overload_ratio: float = OVERLOAD_RATIO
    holds: int = 3
    """holds of the feed in quick succession after which the program is stopped"""

    def __post_init__(self) -> None:
        if not 0.0 < self.floor <= min(self.ceiling, 1.0) <= self.ceiling < inf:
            raise ValueError(
                f"override band {self.floor:g} to {self.ceiling:g}: it must hold 0 < floor ≤ 1 "
                "and floor ≤ ceiling"
            )
        if not self.rise > 0.0 or not self.sensor_timeout > 0.0 or not 0.0 < self.safe <= 1.0:
            raise ValueError(
                "rise and sensor timeout must be positive, the safe override in (0, 1]"
            )
        if not self.overload_ratio > 1.0 or self.holds < 1:
            raise ValueError("the overload ratio must be above 1, holds at least 1")


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkingstepBounds:
    """Bounds of the workingstep that runs."""

    set_point: float
    """N; infinite: nothing bounds the force"""
    breakage: float
    """N"""
    floor: float
    ceiling: float
    exponent: float
    """p of force over feed"""
    settled: float = 0.0
    """N, greatest set point that the force had the time to follow: one that falls at once makes
    no overload of a force that was none"""
    cap: float = inf
    """override that a hold has taught, :func:`taught`"""

    @property
    def strength(self) -> float:
        """N that a tooth may take, so that a sudden rise does not break the tool."""
        return self.breakage / SUDDEN_RATIO

    def threshold(self, band: OverrideBand) -> float:
        """N at which the feed is held."""
        overload = band.overload_ratio * max(self.set_point, self.settled)
        return min(overload, self.strength)

    def load(self, band: OverrideBand, *, level: float, force: float) -> float:
        """Load of a tooth period as the threshold counts it, N.

        Parameters
        ----------
        band : OverrideBand
        level : float, N
            Its force as if all teeth were alike, to be compared with the set point.
        force : float, N
            As measured, to be compared with what the tool bears.
        """
        if self.strength == inf:
            return level
        return max(level, force * self.threshold(band) / self.strength)


@dataclass(frozen=True, slots=True, kw_only=True)
class AllowedOverride:
    """The override that goes to the machine, and what held it."""

    override: float
    holding: OverrideReason = OverrideReason.NOTHING


def aimed(set_point: float, reference: Reference) -> float:
    """The set point, N; less where the tool would not bear a sudden rise from it."""
    return min(set_point, AIMED * reference.breakage / SUDDEN_RATIO)


def allowed(
    wanted: float,
    band: OverrideBand,
    keep: WorkingstepBounds,
    *,
    last: float,
    actual: float,
    force: float,
) -> AllowedOverride:
    """Override that the guard allows a law, in a revolution with chips.

    Parameters
    ----------
    wanted : float
        Any number; what is none counts as the floor.
    band : OverrideBand
    keep : WorkingstepBounds
    last : float
        Override that was commanded last.
    actual : float
        Override that the axes ran in the last revolution.
    force : float, N
        Greatest load of a tooth period (:meth:`WorkingstepBounds.load`), or mean of the
        revolution.
    """
    is_wish = isfinite(wanted) and wanted >= keep.floor
    override = wanted if is_wish else keep.floor
    holding = OverrideReason.NOTHING if is_wish else OverrideReason.BAND
    for name, bound in (
        (OverrideReason.RATE, last * (1.0 + band.rise)),
        (OverrideReason.BAND, keep.ceiling),
        (OverrideReason.FORCE, _by_force(band, keep, actual=actual, force=force)),
    ):
        if override > bound:
            override, holding = bound, name
    return AllowedOverride(override=max(override, 0.0), holding=holding)


def in_air(keep: WorkingstepBounds, *, last: float) -> AllowedOverride:
    """The override without chips: the last, at most the programmed feed."""
    return AllowedOverride(override=min(max(last, keep.floor), keep.ceiling, 1.0))


def after_hold(keep: WorkingstepBounds, *, override: float, force: float) -> float:
    """Override to go on with after a force, N, has held the feed."""
    share = (RESUMED * keep.set_point / force) ** (1.0 / keep.exponent)
    return float(min(max(override * share, LEAST_RESUMED), keep.ceiling, 1.0))


def taught(
    band: OverrideBand, keep: WorkingstepBounds, *, override: float, force: float
) -> float:
    """Override at which the force, N, that has held the feed would have been let through.

    What was met once may be met again in the same workingstep: without it, a program whose
    depth changes over and over would be held each time, and stopped in the end.
    """
    threshold = MARGIN * keep.threshold(band)
    believed = min(force, SUDDEN_RATIO * keep.threshold(band))
    return float(max(override * (threshold / believed) ** (1.0 / keep.exponent), keep.floor))


def _by_force(
    band: OverrideBand, keep: WorkingstepBounds, *, actual: float, force: float
) -> float:
    """Override at which the force measured now would reach the margin of the threshold."""
    threshold = MARGIN * keep.threshold(band)
    if not force > NOTICED * threshold or not actual > 0.0:
        return inf
    return float(actual * (threshold / force) ** (1.0 / keep.exponent))
