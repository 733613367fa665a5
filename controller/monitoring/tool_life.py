"""Flank wear and sudden changes of the work, estimated from measured over expected force.

``F/F_exp = K + s·VB``: hardness multiplies the force of the chip by K, a wear land adds a force
of its own that does not depend on the feed (:mod:`simulator.physics.flank`), and s, what 1 mm
of it adds to the ratio, is therefore greater for thinner chips. Wear is told from hardness by

- the slow trend: K stays as it is between sudden changes, and VB grows at a rate;
- the part of the force that does not fall with the feed: s changes with feed and engagement;
- the force normal to the edge, if a sensor shows it: wear raises it 3.8 times as much as the
  cutting force, hardness raises both alike.

A Kalman filter [3]_ holds K, the sharp ratio of the normal force, VB and its rate; two
cumulative sums [1]_ of what it does not explain detect sudden changes. At such a change the
filter goes back to where the change began, and K is free again while VB is not: unless the
normal force says otherwise. Units: mm of flank wear, s, dimensionless ratios.

A change of the work of less than ``WearMonitorSettings.allowance`` is not detected, and counts
as wear if it stays.

References
----------
.. [1] E. S. Page, "Continuous inspection schemes", Biometrika 41 (1954), 100-115: CUSUM.
.. [2] ISO 8688-2, "Tool life testing in milling": 0.3 mm of flank wear ends a tool's life.
.. [3] Y. Bar-Shalom, X. R. Li, T. Kirubarajan, "Estimation with applications to tracking and
   navigation", Wiley, 2001: linear Kalman filter, nearly constant velocity.
.. [4] J. von Neumann, R. H. Kent, H. R. Bellinson, B. I. Hart, "The mean square successive
   difference", Ann. Math. Stat. 12 (1941), 153-162.
.. [5] D. Simon, "Optimal state estimation", Wiley, 2006, section 7.5: projected estimates.
"""

from dataclasses import dataclass
from math import exp, hypot, inf, isnan, log, nan, sqrt
from typing import NamedTuple

import numpy as np

from controller.signals.ports import Floats
from simulator.physics.domain import require_not_negative, require_positive
from simulator.physics.flank import CUTTING, NORMAL
from simulator.physics.milling import RADIAL_SHARE
from simulator.physics.tool_life import LIFE_CRITERION
from stepnc_model.tuples import quick_replace

_DECISION = 10.0  # standard deviations
_LEAST = 0.02  # least K that is believed
_BOUNDS = np.array([_LEAST, 0.0, 0.0, 0.0])  # of K, sharp normal ratio, VB and its rate
_STILL = np.eye(4)  # step of the belief in no time
_IN_ORDER = (3, 0, 1, 2)  # VB last, as the others move it

FRESH = np.array([0.3, 0.5 * RADIAL_SHARE, 0.005, 0.003])
"""Standard deviations of K, sharp normal ratio, VB in mm and its rate in mm/s at first.

A catalogue's k_c differs by a fifth to a third between sources; 0.003 mm/s ends a life in
100 s.
"""

OTHER_CUT = 0.1
"""Standard deviation of K between cuts of one tool in the same work: errors of the plan."""

TAUGHT = 0.1
"""Standard deviations of K, and of VB in mm, where a sharp tool has taught K in the same cut.

Another batch is harder by a tenth, and the tool may be worn.
"""

DRIFT = 1e-4
"""Standard deviation by which the wear rate changes in 1 s, mm/s^1.5."""

CORRELATED = 10.0
"""Revolutions in which errors of the expected force are alike and do not average out."""

ENTRY = 0.1
"""Standard deviation of ln(ratio) before it is learnt: at an entry sensors lag and settle."""

EXPECTED = 20
"""Number of revolutions as which that counts beside those that were measured."""

PLAN_ERROR = 0.02
"""Flank wear that an error of the expected force may look like, mm: one or two per cent."""

COEFFICIENT = 80.0 / CUTTING
"""Relative standard deviation of the force of a wear land."""

SPREAD = 1.3
"""Ratio of the greatest to the least s from which the feed-independent part is told."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WearMonitorSettings:
    """Settings that separate wear from changes of the work, in ln(ratio) and revolutions.

    Raises
    ------
    ValueError
        If a number is not positive.
    """

    memory: int = 200
    """Number of revolutions over which the noise is learnt."""
    learning: int = 50
    """Number of revolutions before changes are looked for."""
    allowance: float = 0.04
    """Deviation of the ratio that does not add to the sums; at least one standard deviation."""
    decision: float = 0.4
    """Sum from which a change is detected; at least ten standard deviations.

    10 % more force is detected after 8 revolutions, 30 % after 2.
    """

    def __post_init__(self) -> None:
        for name in ("memory", "learning", "allowance", "decision"):
            require_positive(getattr(self, name), name, "")


USUAL = WearMonitorSettings()


class Ratios(NamedTuple):
    """Measured over expected force of one revolution, and what explains it."""

    log_ratio: float
    """ln(measured / expected) of :func:`controller.signals.estimate.log_ratio`."""
    land_share: float
    """Increase s of the ratio by 1 mm of flank wear, 1/mm; 0: not known."""
    period: float = 0.02
    """Time since the last revolution that was compared, in the cut, s."""
    normal: float = nan
    """Measured normal force over expected cutting force; NaN: not measured."""


class _Belief(NamedTuple):
    """Mean (4,) and covariance (4, 4) of K, sharp normal ratio, VB and its rate."""

    mean: Floats
    covariance: Floats


class CumulativeSum(NamedTuple):
    """One-sided cumulative sum (CUSUM), [1]_."""

    total: float = 0.0
    revolutions: int = 0
    """Number of revolutions since the sum was 0."""
    before: _Belief | None = None
    """What was believed when the sum was 0."""


@quick_replace
class ToolLife(NamedTuple):
    """Estimated wear of a tool; create a new one with :func:`new_tool`."""

    belief: _Belief
    log_variance: float = ENTRY**2
    """Variance of the noise of ln(ratio) in single revolutions."""
    away: float = 0.0
    """ln(ratio) of the last revolution less what was explained."""
    readings: int = 0
    """Number of revolutions since the comparison began."""
    above: CumulativeSum = CumulativeSum()
    below: CumulativeSum = CumulativeSum()
    changes: tuple[float, ...] = ()
    """Sudden changes of ln(ratio) so far, as first detected."""
    shares: tuple[float, float] = (inf, 0.0)
    """Least and greatest s of the tool so far, 1/mm."""
    has_normal: bool = False
    """Whether the normal force was measured."""

    @property
    def hardness(self) -> float:
        """Factor K of the chip's force on the catalogue's k_c, without wear."""
        return float(self.belief.mean[0])

    @property
    def flank_wear(self) -> float:
        """Flank wear VB, mm."""
        return max(0.0, float(self.belief.mean[2]))

    @property
    def uncertainty(self) -> float:
        """Standard deviation of the flank wear, with that of the land's coefficient, mm."""
        return hypot(sqrt(float(self.belief.covariance[2, 2])), COEFFICIENT * self.flank_wear)

    @property
    def is_worn_out(self) -> bool:
        """True if the flank wear has surely reached the end of tool life, [2]_."""
        noise = sqrt(float(self.belief.covariance[2, 2]))
        return self.flank_wear >= LIFE_CRITERION and noise < 0.25 * LIFE_CRITERION

    @property
    def basis(self) -> str:
        """Basis of the wear estimate, in words."""
        least, greatest = self.shares
        found = ["the slow rise of the force"]
        if greatest > SPREAD * least:
            found.append("the part of it that does not fall with the feed")
        if self.has_normal:
            found.append("the force normal to the edge")
        return ", ".join(found[:-1]) + " and " * (len(found) > 1) + found[-1]

    @property
    def is_wear_sure(self) -> bool:
        """True if there is wear beyond three standard deviations and the errors of the plan."""
        noise = sqrt(float(self.belief.covariance[2, 2]))
        return self.flank_wear > max(3.0 * noise, PLAN_ERROR)

    def sharp(self, log_ratio: float, land_share: float) -> float:
        """Return ln(measured / expected) less the force of the land, if there surely is one."""
        if not self.is_wear_sure:
            return log_ratio
        return log(max(exp(log_ratio) - land_share * self.flank_wear, _LEAST))

    def share(self, land_share: float) -> float:
        """Share of the wear land in the force where 1 mm of it adds so much to the ratio."""
        land = land_share * self.flank_wear
        return land / (land + max(self.hardness, _LEAST))


def new_tool(flank: float = 0.0) -> ToolLife:
    """Create the state of a tool without measurements, with its initial flank wear in mm."""
    require_not_negative(flank, "flank wear", "mm")
    mean = np.array([1.0, RADIAL_SHARE, flank, 0.0])
    return ToolLife(belief=_Belief(mean=mean, covariance=np.diag(FRESH**2)))


def compared_anew(life: ToolLife) -> ToolLife:
    """Go on with another cut of the same tool, where the plan may err by another amount."""
    if not life.readings:
        return life
    return _restarted(life, _freed(life.belief, OTHER_CUT), life.changes)


def taught(life: ToolLife, hardness: float) -> ToolLife:
    """Take over the factor K that the tool had in this cut when it was sharp."""
    require_positive(hardness, "factor of the reference load", "")
    covariance = life.belief.covariance.copy()
    covariance[0, :] = covariance[:, 0] = 0.0
    covariance[0, 0] = (TAUGHT * hardness) ** 2
    covariance[2, 2] = max(covariance[2, 2], TAUGHT**2)
    mean = life.belief.mean.copy()
    mean[0] = hardness
    return life._replace(belief=_Belief(mean=mean, covariance=covariance))


def lived(life: ToolLife, at: Ratios, *, by: WearMonitorSettings = USUAL) -> ToolLife:
    """Update the wear estimate of the tool with one more revolution."""
    readings = life.readings + 1
    predicted = _predicted(life.belief, at.period)
    explained = max(_explained(predicted, at), _LEAST)
    away = at.log_ratio - log(explained) if life.readings else 0.0
    part = max(1.0 / (readings + EXPECTED), 1.0 / by.memory)
    log_variance = (1.0 - part) * life.log_variance + part * _variance(away, life)
    deviation = max(sqrt(log_variance), 0.25 * by.allowance)
    allowance = max(by.allowance, deviation)
    decision = max(by.decision, _DECISION * deviation)
    above, below, (least, greatest) = life.above, life.below, life.shares
    if readings > by.learning:
        above = _summed(above, away - allowance, life.belief)
        below = _summed(below, -away - allowance, life.belief)
    if at.land_share > 0.0:
        least, greatest = min(least, at.land_share), max(greatest, at.land_share)
    moved = life._replace(
        belief=_updated(predicted, at, deviation=deviation),
        log_variance=log_variance,
        away=away,
        readings=readings,
        above=above,
        below=below,
        shares=(least, greatest),
        has_normal=life.has_normal or not isnan(at.normal),
    )
    if readings <= by.learning:
        return moved
    if above.total > decision:
        return _changed(moved, above.total / above.revolutions + allowance, above, at)
    if below.total > decision:
        return _changed(moved, -below.total / below.revolutions - allowance, below, at)
    return moved


def _variance(away: float, life: ToolLife) -> float:
    """Variance from the difference of successive revolutions, [4]_.

    The distance from what is explained is no noise: a filter that took it for such would
    believe a wrong start the longer, the more wrong it is.
    """
    step = away - life.away
    return 0.5 * step * step


def _explained(belief: _Belief, at: Ratios) -> float:
    """Ratio that is expected of K and VB."""
    return float(belief.mean[0] + at.land_share * belief.mean[2])


def _predicted(belief: _Belief, period: float) -> _Belief:
    """Belief some seconds of cutting later: VB grows at its rate, the rate wanders."""
    step = _STILL.copy()
    step[2, 3] = period
    covariance = step @ belief.covariance @ step.T
    covariance[3, 3] += DRIFT**2 * period
    return _Belief(mean=step @ belief.mean, covariance=covariance)


def _updated(belief: _Belief, at: Ratios, *, deviation: float) -> _Belief:
    """Belief after a revolution; a ratio without known land changes K alone."""
    ratio = exp(at.log_ratio)
    error = CORRELATED * (deviation * ratio) ** 2
    row = np.array([1.0, 0.0, at.land_share, 0.0])
    belief = _measured(belief, row, ratio, error)
    if not isnan(at.normal):
        row = np.array([0.0, 1.0, at.land_share * NORMAL / CUTTING, 0.0])
        error = CORRELATED * (deviation * max(abs(at.normal), _LEAST)) ** 2
        belief = _measured(belief, row, at.normal, error)
    return _physical(belief)


def _physical(belief: _Belief) -> _Belief:
    """Belief with each quantity at its bound if it is below, the others as likely then.

    Wear does not heal, and no work is softer than nothing. The projection of [5]_ on one active
    constraint after the other, weighted with the inverse covariance.
    """
    if (belief.mean >= _BOUNDS).all():
        return belief
    mean, covariance = belief.mean, belief.covariance
    for at in _IN_ORDER:
        short = float(_BOUNDS[at] - mean[at])
        if short > 0.0:
            mean = mean + covariance[:, at] * (short / float(covariance[at, at]))
    # A later projection may have moved an earlier quantity a little.
    return _Belief(mean=np.maximum(mean, _BOUNDS), covariance=covariance)


def _measured(belief: _Belief, row: Floats, value: float, error: float) -> _Belief:
    """One linear measurement with the variance of its error."""
    towards = belief.covariance @ row
    spread = float(row @ towards) + error
    mean = belief.mean + towards * ((value - float(row @ belief.mean)) / spread)
    covariance = belief.covariance - towards[:, None] * towards / spread
    return _Belief(mean=mean, covariance=0.5 * (covariance + covariance.T))


def _freed(belief: _Belief, deviation: float, *, wear: float = 0.0) -> _Belief:
    """Belief in which K may differ, and the sharp normal ratio in proportion to it."""
    along = np.array([belief.mean[0], belief.mean[1], 0.0, 0.0]) * deviation
    covariance = belief.covariance + np.outer(along, along)
    covariance[2, 2] += wear**2
    return _Belief(mean=belief.mean, covariance=covariance)


def _summed(drift: CumulativeSum, step: float, before: _Belief) -> CumulativeSum:
    """Add one step to a cumulative sum, which never falls below 0."""
    total = drift.total + step
    if total <= 0.0:
        return CumulativeSum()
    return CumulativeSum(
        total=total, revolutions=drift.revolutions + 1, before=drift.before or before
    )


def _changed(life: ToolLife, change: float, drift: CumulativeSum, at: Ratios) -> ToolLife:
    """Go back to where a sudden change by e^change began, and let K differ from then on.

    Where the normal force is measured, the wear may differ as well: an edge may have chipped.
    """
    before = drift.before or life.belief
    wear = 0.0 if isnan(at.normal) else LIFE_CRITERION
    # The change of the chip's force is greater than that of the whole, which holds wear too.
    freed = _freed(
        before, 2.0 * max(abs(exp(change) - 1.0), 0.1) * _whole(before, at), wear=wear
    )
    belief = _updated(freed, at, deviation=sqrt(life.log_variance / CORRELATED))
    return _restarted(life, belief, (*life.changes, change))


def _whole(belief: _Belief, at: Ratios) -> float:
    """Whole force over the force of the chip."""
    return max(_explained(belief, at), _LEAST) / max(float(belief.mean[0]), _LEAST)


def _restarted(life: ToolLife, belief: _Belief, changes: tuple[float, ...]) -> ToolLife:
    """Life whose comparison begins anew."""
    return life._replace(
        belief=belief,
        readings=0,
        log_variance=ENTRY**2,
        away=0.0,
        above=CumulativeSum(),
        below=CumulativeSum(),
        changes=changes,
    )
