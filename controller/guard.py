"""The guard between any law and the machine: what a law wants is only a wish.

What it promises: the force stays below the breakage force whatever the law does, when

- the first contact at an override of 1 stays below the breakage force over the sudden ratio,
  which is the planner's promise;
- within the time in which the feed follows, the force rises at a given feed no more than by
  the sudden ratio, once;
- the sensors show the force, or are known to be silent.

The threshold is then the breakage force over the sudden ratio, or 1.5 times the set point where
that is less. The override is held so low that the force measured now would stay below it, and
the feed is held within one tooth period when a tooth passes it. Units s, N.
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


NOTICED = 1e-3
"""of the threshold, below which a force bounds no override"""


class Holding(StrEnum):
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
class Band:
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
    silence: float = 0.5
    """s without a reading after which it holds"""
    overload_ratio: float = OVERLOAD_RATIO
    holds: int = 3
    """holds of the feed in one workingstep after which the program is stopped"""

    def __post_init__(self) -> None:
        if not 0.0 < self.floor <= min(self.ceiling, 1.0) <= self.ceiling < inf:
            raise ValueError(
                f"override band {self.floor:g} to {self.ceiling:g}: it must hold 0 < floor ≤ 1 "
                "and floor ≤ ceiling"
            )
        if not self.rise > 0.0 or not self.silence > 0.0 or not 0.0 < self.safe <= 1.0:
            raise ValueError("rise and silence must be positive, the safe override in (0, 1]")
        if not self.overload_ratio > 1.0 or self.holds < 1:
            raise ValueError("the overload ratio must be above 1, holds at least 1")


@dataclass(frozen=True, slots=True, kw_only=True)
class Keeping:
    """What holds in the workingstep that runs."""

    set_point: float
    """N; infinite: nothing bounds the force"""
    breakage: float
    """N"""
    floor: float
    ceiling: float
    exponent: float
    """p of force over feed"""

    def threshold(self, band: Band) -> float:
        """N at which the feed is held."""
        return min(band.overload_ratio * self.set_point, self.breakage / SUDDEN_RATIO)


@dataclass(frozen=True, slots=True, kw_only=True)
class Allowed:
    """The override that goes to the machine, and what held it."""

    override: float
    holding: Holding = Holding.NOTHING


def keeping(
    band: Band, reference: Reference, *, set_point: float, exponent: float, most: float = inf
) -> Keeping:
    """The band of a workingstep: the user's, narrowed by what the workingstep allows.

    Parameters
    ----------
    band : Band
    reference : Reference
    set_point : float, N
        Infinite: none.
    exponent : float
        p of force over feed.
    most : float
        Override that the mode allows.
    """
    ceiling = min(band.ceiling, reference.ceiling, most)
    return Keeping(
        set_point=set_point,
        breakage=reference.breakage,
        floor=min(max(band.floor, reference.floor), ceiling),
        ceiling=ceiling,
        exponent=exponent,
    )


def allowed(
    wanted: float, band: Band, keep: Keeping, *, last: float, actual: float, force: float
) -> Allowed:
    """What a law gets of what it wants, in a revolution with chips.

    Parameters
    ----------
    wanted : float
        Any number; what is none counts as the floor.
    band : Band
    keep : Keeping
    last : float
        Override that was commanded last.
    actual : float
        Override that the axes ran in the last revolution.
    force : float, N
        Greatest mean of a tooth period or of the revolution, measured.
    """
    is_wish = isfinite(wanted) and wanted >= keep.floor
    override = wanted if is_wish else keep.floor
    holding = Holding.NOTHING if is_wish else Holding.BAND
    for name, bound in (
        (Holding.RATE, last * (1.0 + band.rise)),
        (Holding.BAND, keep.ceiling),
        (Holding.FORCE, _by_force(band, keep, actual=actual, force=force)),
    ):
        if override > bound:
            override, holding = bound, name
    return Allowed(override=max(override, 0.0), holding=holding)


def in_air(keep: Keeping, *, last: float) -> Allowed:
    """The override without chips: the last, at most the programmed feed."""
    return Allowed(override=min(max(last, keep.floor), keep.ceiling, 1.0))


def after_hold(keep: Keeping, *, override: float, force: float) -> float:
    """Override to go on with after a force, N, has held the feed."""
    share = (RESUMED * keep.set_point / force) ** (1.0 / keep.exponent)
    return min(max(override * share, 0.0), keep.ceiling, 1.0) or keep.floor


def _by_force(band: Band, keep: Keeping, *, actual: float, force: float) -> float:
    """Override at which the force measured now would reach the margin of the threshold."""
    threshold = MARGIN * keep.threshold(band)
    if not force > NOTICED * threshold or not actual > 0.0:
        return inf
    return float(actual * (threshold / force) ** (1.0 / keep.exponent))
