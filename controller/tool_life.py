"""Flank wear and sudden changes of the work, estimated from the force ratio.

Wear raises the force slowly, harder work at once. A slowly moving mean follows the ratio of
measured to expected force, and two cumulative sums detect changes that are too quick for it.
Wear is the increase of that mean since the tool was new, divided by the increase per millimetre
of wear: the wear land takes a force of its own beside that of the chip, so that this is larger
for thin chips (:mod:`simulator.physics.flank`). After a sudden change the reference is learnt
anew, and the wear continues from its previous value. Units: mm of flank wear, dimensionless
ratios.

A change of less than ``WearMonitorSettings.allowance`` is not detected and counts as wear: 4 %
of force are 0.02 mm where a chip of 0.1 mm is cut in steel. Wear that is quicker than the
allowance over the memory (0.04 in 200 revolutions) is taken for a change. So is an error of the
expected force that lasts some revolutions: noise may be large, but it must not keep the same
sign for long.

References
----------
.. [1] E. S. Page, "Continuous inspection schemes", Biometrika 41 (1954), 100-115: CUSUM.
.. [2] ISO 8688-2, "Tool life testing in milling": 0.3 mm of flank wear ends a tool's life.
"""

from dataclasses import dataclass, replace
from math import exp, log, sqrt

from simulator.physics.domain import require_not_negative, require_positive
from simulator.physics.tool_life import LIFE_CRITERION

_DECISION = 10.0  # standard deviations
_LEAST_SHARP = 0.05  # least share of the chip in the force, however worn the tool was at first


@dataclass(frozen=True, slots=True, kw_only=True)
class WearMonitorSettings:
    """Settings that separate wear from changes of the work, in ln(ratio) and revolutions.

    Raises
    ------
    ValueError
        If a number is not positive.
    """

    memory: int = 200
    """Number of revolutions after which a revolution is weighted 1/e."""
    learning: int = 50
    """Number of revolutions that form the reference mean for wear."""
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


@dataclass(frozen=True, slots=True, kw_only=True)
class CumulativeSum:
    """One-sided cumulative sum (CUSUM), [1]_."""

    total: float = 0.0
    revolutions: int = 0
    """Number of revolutions since the sum was 0."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolLife:
    """Estimated wear of a tool; create a new one with :func:`new_tool`."""

    log_ratio: float = 0.0
    """Slowly moving mean of ln(measured / expected)."""
    log_sharp: float = 0.0
    """Estimate of that mean for a sharp tool."""
    land_share: float = 0.0
    """Slowly moving mean of the increase of the ratio per mm of flank wear, 1/mm; 0: not
    known."""
    log_variance: float = 0.0
    """Variance of single revolutions about the mean."""
    begun: float = 0.0
    """Flank wear when the comparison began, mm."""
    readings: int = 0
    """Number of revolutions since the comparison began."""
    above: CumulativeSum = CumulativeSum()
    below: CumulativeSum = CumulativeSum()
    changes: tuple[float, ...] = ()
    """Sudden changes of ln(ratio) so far, as first detected."""

    @property
    def ratio(self) -> float:
        """Slowly moving ratio of measured to expected force; 1 before any measurement."""
        return exp(self.log_ratio)

    @property
    def flank_wear(self) -> float:
        """Flank wear VB, mm: increase of the ratio over its increase per millimetre."""
        if self.readings == 0 or self.land_share <= 0.0:
            return self.begun
        return max(0.0, (exp(self.log_ratio) - exp(self.log_sharp)) / self.land_share)

    @property
    def is_worn_out(self) -> bool:
        """Whether the flank wear has reached the end of tool life, [2]_."""
        return self.flank_wear >= LIFE_CRITERION


def new_tool(flank: float = 0.0) -> ToolLife:
    """Create the state of a tool without measurements, with its initial flank wear in mm."""
    require_not_negative(flank, "flank wear", "mm")
    return ToolLife(begun=flank)


def compared_anew(life: ToolLife) -> ToolLife:
    """Restart the comparison for other work: the wear stays, the ratio is learnt anew.

    For known changes, such as another material or a cut for which the error of the expected
    force differs.
    """
    return ToolLife(
        log_ratio=life.log_ratio,
        log_sharp=life.log_sharp,
        land_share=life.land_share,
        begun=life.flank_wear,
        changes=life.changes,
    )


def lived(
    life: ToolLife, ratio: float, *, land_share: float, by: WearMonitorSettings = USUAL
) -> ToolLife:
    """Update the wear estimate of the tool with one more revolution.

    Parameters
    ----------
    life : ToolLife
    ratio : float
        ln(measured / expected) of :func:`controller.estimate.log_ratio`.
    land_share : float, 1/mm
        Increase of the ratio by 1 mm of flank wear; 0: not known, and no wear is estimated.
    by : WearMonitorSettings
    """
    readings = life.readings + 1
    away = ratio - life.log_ratio if life.readings else 0.0
    part = max(1.0 / readings, 1.0 / by.memory)
    mean = life.log_ratio + part * away if life.readings else ratio
    moved = replace(
        life,
        log_ratio=mean,
        log_variance=(1.0 - part) * (life.log_variance + part * away * away),
        land_share=life.land_share + part * (land_share - life.land_share),
        readings=readings,
    )
    if readings <= by.learning:
        return replace(moved, log_sharp=_sharp(moved))
    deviation = sqrt(life.log_variance)
    allowance = max(by.allowance, deviation)
    decision = max(by.decision, _DECISION * deviation)
    above = _summed(life.above, away - allowance)
    below = _summed(life.below, -away - allowance)
    moved = replace(moved, above=above, below=below)
    if above.total > decision:
        return _changed(moved, above.total / above.revolutions + allowance, above, by)
    if below.total > decision:
        return _changed(moved, -below.total / below.revolutions - allowance, below, by)
    return moved


def _sharp(life: ToolLife) -> float:
    """Logarithm of the ratio without the wear present when the comparison began."""
    share = life.land_share * life.begun * exp(-life.log_ratio)
    return life.log_ratio + log(max(1.0 - share, _LEAST_SHARP))


def _summed(drift: CumulativeSum, step: float) -> CumulativeSum:
    """Add one step to a cumulative sum, which never falls below 0."""
    total = drift.total + step
    return (
        CumulativeSum(total=total, revolutions=drift.revolutions + 1)
        if total > 0.0
        else CumulativeSum()
    )


def _changed(
    life: ToolLife, change: float, drift: CumulativeSum, by: WearMonitorSettings
) -> ToolLife:
    """Restart after a sudden change of the force by e^change; the wear stays as before it."""
    # The mean has partly followed the change before it was detected.
    followed = change * drift.revolutions / by.memory
    before = replace(life, log_ratio=life.log_ratio - followed, changes=(*life.changes, change))
    return compared_anew(before)
