"""Bounds along the path that follow from the advice for a workingstep."""

from optimiser.advice import Advice
from optimiser.along_path.caps import CapName, CutBounds
from optimiser.bounds.limits import STRAIGHT_DOWN, depth_at_shoulder
from optimiser.bounds.plunge_feed import permitted_plunge
from optimiser.solver.problem import BoundSide, LimitName

FIXED = {
    LimitName.ROUGHNESS: CapName.ROUGHNESS,
    LimitName.PROGRAMMED_FEED: CapName.LOCKED,
    LimitName.CHUCK_TORQUE: CapName.HOLDING,
    LimitName.TILTING_MOMENT: CapName.HOLDING,
    LimitName.BAR_DEFLECTION: CapName.HOLDING,
    LimitName.HOLDING_FORCE: CapName.HOLDING,
}
"""Limits that hold alike at every place of a workingstep with chips."""


def bounds_of(advice: Advice) -> CutBounds | None:
    """Bounds along the path of a workingstep; None if its feed may not be chosen.

    Loads that depend on the engagement get a cap of their own at each place, as does a shoulder
    that is too deep. Roughness and work-holding keep the feed that the whole workingstep may
    have.
    """
    state = advice.after
    if state is None or advice.cut is None or advice.conditions is None:
        return None
    fixed: dict[CapName, float] = {}
    for load in state.loads:
        name = FIXED.get(load.limit.name)
        is_down = load.limit.words.endswith(STRAIGHT_DOWN)
        is_elsewhere = is_down or load.limit.stands_for is LimitName.AXIAL_DEPTH
        if name is None or is_elsewhere or load.limit.sense is not BoundSide.AT_MOST:
            continue
        feed = load.limit.feed_at_bound(state.setting.depth, state.setting.speed)
        fixed[name] = min(feed, fixed.get(name, feed))
    return CutBounds(
        cut=advice.cut,
        at=advice.conditions,
        fixed=tuple(fixed.items()),
        plunge=permitted_plunge(advice.cut, advice.conditions),
        deepest=depth_at_shoulder(advice.cut, advice.conditions),
    )
