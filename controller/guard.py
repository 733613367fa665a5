"""Safety guard between the control law and the machine, which limits the requested override.

It guarantees that the mean force of a tooth period stays below the breakage force, whatever the
law requests, provided that

- where the cutter enters the work at an override of 1, the most loaded tooth stays below the
  breakage force over the sudden ratio: this is what the planner ensures, plus what the work
  conceals. The air before must last until the feed has come down to 1; otherwise this must
  hold at the ceiling;
- at a given feed the force rises by no more than the sudden ratio from one revolution to the
  next ones, once within the time in which the feed follows;
- the sensors show the force within a fraction of a tooth period, or are known to be silent. The
  power of a main drive does not meet this: it is delayed.

The threshold is the breakage force over the sudden ratio, or 1.5 times the set point where that
is less. The override is kept so low that the force measured now would stay below it, but not
below the least chip, where the edge would rub and not cut; and the feed is held within one
tooth period when a tooth exceeds it. Against the set point, a tooth
counts with its excess over its usual share (:mod:`controller.monitoring.overload`), against the
breakage force with its full force. Where the program inhibits the override there is no
guarantee. Units: s, N.
"""

from dataclasses import dataclass
from enum import StrEnum
from math import inf, isfinite
from typing import NamedTuple

from controller.reference import Reference

OVERLOAD_RATIO = 1.5
"""Ratio of force to set point at which the feed is held."""

SUDDEN_RATIO = 2.0
"""Greatest sudden rise of the force at the same feed: the depth of a second pass."""

MARGIN = 0.95
"""Share of the threshold up to which the override is raised, leaving room for noise."""

RESUMED = 0.8
"""Share of the set point that is targeted after a feed hold."""

AIMED = 0.8
"""Greatest set point as a share of the breakage force over the sudden ratio.

A law that keeps the set point must not reach the threshold through noise.
"""

LEAST_RESUMED = 0.02
"""Least override after a feed hold, so that a false force reading does not stall the feed.

The least chip of a workingstep is mostly more.
"""

NOTICED = 1e-3
"""Share of the threshold below which a force does not limit the override."""


class OverrideReason(StrEnum):
    """Reason why the guard limited or replaced the override of the law."""

    NOTHING = "nothing"
    BAND = "override band"
    RATE = "rate limit"
    FORCE = "force guard"
    OVERLOAD = "overload"
    SILENCE = "no force reading"
    OFF = "switched off"
    INHIBITED = "the program inhibits the override"
    STOPPED = "stopped"
    OPERATOR = "the operator"
    OPERATOR_HOLD = "held by the operator"


@dataclass(frozen=True, slots=True, kw_only=True)
class OverrideBand:
    """Band in which the override may move, with the timeouts and limits of the guard.

    Raises
    ------
    ValueError
        When the band is empty or a value is out of range.
    """

    floor: float = 0.2
    ceiling: float = 1.2
    rise: float = 0.25
    """Greatest relative rise of the override per revolution; falling is not limited."""
    safe: float = 0.5
    """Override that applies without force readings."""
    sensor_timeout: float = 0.5
    """Time without a reading after which the safe override applies, s."""
    overload_ratio: float = OVERLOAD_RATIO
    holds: int = 3
    """Number of feed holds in quick succession that the loop allows; one more stops the
    program."""

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
    """Force and override bounds of the running workingstep."""

    set_point: float
    """Set point of the force, N; infinite if nothing limits the force."""
    breakage: float
    """Breakage force of the tool, N."""
    floor: float
    ceiling: float
    exponent: float
    """Exponent p of force over feed."""
    least: float = 0.0
    """Override of the least chip: the feed is held rather than lowered further."""
    settled: float = 0.0
    """Greatest set point that the force had time to follow, N.

    A set point that falls at once must not turn an acceptable force into an overload.
    """
    cap: float = inf
    """Upper limit of the override learnt from a feed hold, :func:`taught`."""

    @property
    def strength(self) -> float:
        """Force of a tooth, N, from which a sudden rise still does not break the tool."""
        return self.breakage / SUDDEN_RATIO

    def threshold(self, band: OverrideBand) -> float:
        """Force of a tooth at which the feed is held, N."""
        overload = band.overload_ratio * max(self.set_point, self.settled)
        return min(overload, self.strength)

    def load(self, band: OverrideBand, *, level: float, force: float) -> float:
        """Load of a tooth period as compared with the threshold, N.

        Parameters
        ----------
        level : float, N
            Force as if all teeth were alike, compared with the set point.
        force : float, N
            Measured force, compared with the strength of the tool.
        """
        if self.strength == inf:
            return level
        return max(level, force * self.threshold(band) / self.strength)


class AllowedOverride(NamedTuple):
    """Override that is sent to the machine, and the reason if it was limited."""

    override: float
    holding: OverrideReason = OverrideReason.NOTHING


def aimed(set_point: float, reference: Reference) -> float:
    """Set point reduced, if necessary, so that the tool withstands a sudden rise, N."""
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
    """Limit the override requested by a law, in a revolution with chips.

    Parameters
    ----------
    wanted : float
        Requested override; NaN or infinity counts as the floor.
    last : float
        Last commanded override.
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
    return AllowedOverride(override=max(override, keep.least, 0.0), holding=holding)


def in_air(keep: WorkingstepBounds, *, last: float) -> AllowedOverride:
    """Override without chips: the last one, but at most the programmed feed."""
    return AllowedOverride(override=min(max(last, keep.floor), keep.ceiling, 1.0))


def after_hold(keep: WorkingstepBounds, *, override: float, force: float) -> float:
    """Override at which to resume after a force, N, has held the feed."""
    share = (RESUMED * keep.set_point / force) ** (1.0 / keep.exponent)
    least = max(LEAST_RESUMED, keep.least)
    return float(min(max(override * share, least), keep.ceiling, 1.0))


def taught(
    band: OverrideBand, keep: WorkingstepBounds, *, override: float, force: float
) -> float:
    """Override at which the force, N, that held the feed would not have done so.

    The same load may occur again in the workingstep: without this limit, a program with
    alternating depths would be held each time and finally stopped.
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
