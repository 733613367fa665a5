"""Flank wear, told by the force; and changes of the work, told from wear.

Wear raises the force slowly, harder work at once. A slowly moving mean follows the ratio of
measured to expected force, and two cumulative sums look for a change that is too quick for it.
Wear is what that mean has gained since the tool was new, over what a millimetre of wear adds
to the ratio: the wear land takes a force of its own beside that of the chip, so that this is
more for thin chips (:mod:`simulator.physics.flank`). After a sudden change what it is compared
with is learnt anew, and the wear goes on from where it was. Units mm of flank wear,
dimensionless ratios.

A change of less than ``WearMonitorSettings.allowance`` is not seen and counts as wear: 4 % of
force are 0.02 mm where a chip of 0.1 mm is cut in steel. Wear that is quicker than the
allowance over the memory (0.04 in 200 revolutions) is taken for a change. So is an error of the
expected force that lasts some revolutions: noise may be large, but it must not be of one sign
for long.

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
_LEAST_SHARP = 0.05  # of the force, that a chip takes however worn the tool began


@dataclass(frozen=True, slots=True, kw_only=True)
class WearMonitorSettings:
    """Settings for telling wear from a change of the work, in ln(ratio) and revolutions.

    Raises
    ------
    ValueError
        If a number is not positive.
    """

    memory: int = 200
    """revolutions after which one counts 1/e"""
    learning: int = 50
    """revolutions that make the mean with which wear is compared"""
    allowance: float = 0.04
    """by which the ratio may be off without adding up; one standard deviation at least"""
    decision: float = 0.4
    """sum from which it is a change, ten standard deviations at least: 10 % of force are one
    after 8 revolutions, 30 % after 2"""

    def __post_init__(self) -> None:
        for name in ("memory", "learning", "allowance", "decision"):
            require_positive(getattr(self, name), name, "")


USUAL = WearMonitorSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class CumulativeSum:
    """A one-sided cumulative sum, [1]_."""

    total: float = 0.0
    revolutions: int = 0
    """since it was 0"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolLife:
    """Estimated wear of a tool. A new one for a new tool: :func:`new_tool`."""

    log_ratio: float = 0.0
    """slowly moving mean of ln(measured / expected)"""
    log_sharp: float = 0.0
    """what it would be with a sharp tool"""
    land_share: float = 0.0
    """slowly moving mean of what 1 mm of flank wear adds to the ratio, 1/mm; 0: not known"""
    log_variance: float = 0.0
    """of single ones about the mean"""
    begun: float = 0.0
    """mm of flank wear when comparing began"""
    readings: int = 0
    """revolutions since then"""
    above: CumulativeSum = CumulativeSum()
    below: CumulativeSum = CumulativeSum()
    changes: tuple[float, ...] = ()
    """sudden changes of ln(ratio) so far, as first seen"""

    @property
    def ratio(self) -> float:
        """Measured over expected force, slowly moving; 1 before anything was measured."""
        return exp(self.log_ratio)

    @property
    def flank_wear(self) -> float:
        """VB in mm: what the ratio has gained over what a millimetre adds to it."""
        if self.readings == 0 or self.land_share <= 0.0:
            return self.begun
        return max(0.0, (exp(self.log_ratio) - exp(self.log_sharp)) / self.land_share)

    @property
    def is_worn_out(self) -> bool:
        """Whether the end of the tool's life is reached, [2]_."""
        return self.flank_wear >= LIFE_CRITERION


def new_tool(flank: float = 0.0) -> ToolLife:
    """A tool of which nothing was measured yet, with its flank wear in mm when it begins."""
    require_not_negative(flank, "flank wear", "mm")
    return ToolLife(begun=flank)


def compared_anew(life: ToolLife) -> ToolLife:
    """The tool in other work: the wear stays, the ratio is learnt anew.

    For a change that is known of, such as another material or a kind of cut for which the
    expected force errs otherwise.
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
    """The tool after one more revolution.

    Parameters
    ----------
    life : ToolLife
    ratio : float
        ln(measured / expected) of :func:`controller.estimate.log_ratio`.
    land_share : float, 1/mm
        What 1 mm of flank wear adds to the ratio; 0: not known, and then no wear is told.
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
    """Ln of the ratio without the wear with which comparing began."""
    share = life.land_share * life.begun * exp(-life.log_ratio)
    return life.log_ratio + log(max(1.0 - share, _LEAST_SHARP))


def _summed(drift: CumulativeSum, step: float) -> CumulativeSum:
    """The sum with one more step; it never is below 0."""
    total = drift.total + step
    return (
        CumulativeSum(total=total, revolutions=drift.revolutions + 1)
        if total > 0.0
        else CumulativeSum()
    )


def _changed(
    life: ToolLife, change: float, drift: CumulativeSum, by: WearMonitorSettings
) -> ToolLife:
    """The tool in work that takes about e^change times the force, its wear as it was before."""
    # The mean has followed the change a little while it added up.
    followed = change * drift.revolutions / by.memory
    before = replace(life, log_ratio=life.log_ratio - followed, changes=(*life.changes, change))
    return compared_anew(before)
