"""What held the override is told by the guard, or by whose end of the band it is at."""

from math import inf

import numpy as np
import pytest

from controller.cycle import LoopCycle
from controller.guard import AllowedOverride, OverrideBand, OverrideReason
from controller.monitoring.threshold import AlarmLevel
from controller.orders import Criterion, EventKind, LoopEvent
from controller.reference import ForceBound, Reference
from controller.signals.signal import Revolution
from controller.states.loop_settings import LoopSettings
from optimiser.solver.problem import LimitName
from service.control.holding import (
    AROUND,
    BOTTOM,
    FORCE_ORDER,
    FREE,
    NO_CHIPS,
    OFF,
    PROGRAMMED,
    STRENGTH,
    TOP,
    HoldTallies,
    OverrideLimits,
    ends_of,
    reason,
)
from service.control.run import ControlRun
from simulator.reading import Reading

AIMS = LoopSettings(band=OverrideBand(floor=0.2, ceiling=1.2))
DEFLECTION = ForceBound(name=LimitName.TOOL_DEFLECTION, words="tool deflection", force=500.0)
ENDS = OverrideLimits(
    reference=Reference(workingstep="A", bounds=(DEFLECTION,), breakage=2000.0),
    ceiling=(1.1, "roughness"),
    floor=(0.4, "chip thickness"),
)


def cycle(
    override: float = 1.0,
    *,
    force: float | None = 400.0,
    holding: OverrideReason = OverrideReason.NOTHING,
    set_point: float = 500.0,
    events: tuple[LoopEvent, ...] = (),
) -> LoopCycle:
    """A revolution of one tooth that ends after a second; None: there is none."""
    reading = Reading(
        time=1.0, period=0.02, force=np.full(4, force or 0.0), power=0.0, feed=5.0,
        override=override, spindle_speed=50.0, teeth=1, tooth=0, progress=1.0, workingstep=1,
        can_override=True,
    )  # fmt: skip
    turn = None
    if force is not None:
        turn = Revolution(
            time=1.0, period=0.02, force=force, peak=force, tooth_peaks=np.full(1, force),
            tooth_means=np.full(1, force), tooth_feeds=np.full(1, 5.0),
            tooth_overrides=np.full(1, override), samples=4, first=0, coverage=1.0, power=0.0,
            feed=5.0,
            override=override, spindle_speed=50.0, progress=1.0, progress_before=0.98,
            workingstep=1, tooth_passing=0.0, once_per_revolution=0.0,
        )  # fmt: skip
    return LoopCycle(
        reading=reading,
        allowed=AllowedOverride(override=override, holding=holding),
        set_point=set_point,
        revolution=turn,
        expected=0.0,
        ratio=None,
        events=events,
    )


@pytest.mark.parametrize(
    ("override", "ends", "words"),
    [
        (1.0, ENDS, "tool deflection"),
        (1.1, ENDS, "roughness"),
        (0.4, ENDS, "chip thickness"),
        (1.2, OverrideLimits(reference=ENDS.reference), TOP),
        (0.2, OverrideLimits(reference=ENDS.reference), BOTTOM),
    ],
)
def test_an_end_of_the_band_is_somebodys(
    override: float, ends: OverrideLimits, words: str
) -> None:
    assert reason(cycle(override), ends, AIMS) == words


@pytest.mark.parametrize(
    "holding",
    sorted(
        set(OverrideReason) - {OverrideReason.NOTHING, OverrideReason.BAND, OverrideReason.OFF}
    ),
)
def test_the_guard_has_the_last_word(holding: OverrideReason) -> None:
    assert reason(cycle(1.2, holding=holding), ENDS, AIMS) == holding.value


def test_a_control_that_is_off_holds_nothing() -> None:
    assert reason(cycle(1.0, holding=OverrideReason.OFF), ENDS, AIMS) == OFF


def test_the_mode_may_hold_it() -> None:
    settings = LoopSettings(criterion=Criterion.QC, band=AIMS.band)
    assert reason(cycle(1.0), ENDS, settings) == PROGRAMMED
    assert reason(cycle(0.9), ENDS, settings) == "tool deflection"


def test_nothing_may_hold_it() -> None:
    assert reason(cycle(1.0, set_point=inf), AROUND, AIMS) == FREE


def test_the_force_follows_from_the_user_the_plan_or_the_tool() -> None:
    assert ENDS.force_bound(AIMS) == "tool deflection"
    assert ENDS.force_bound(LoopSettings(set_point=100.0)) == FORCE_ORDER
    assert ENDS.force_bound(LoopSettings(set_point=5000.0)) == STRENGTH
    assert AROUND.force_bound(AIMS) == ""


def test_time_with_chips_is_shared_out() -> None:
    holdings = HoldTallies([])
    for each in (cycle(1.2), cycle(1.2), cycle(1.2), cycle(1.0, set_point=inf)):
        holdings.add(each, AIMS)
    holdings.add(cycle(1.0, force=2.0), AIMS)
    assert holdings.words == NO_CHIPS
    holdings.add(cycle(1.0, force=None), AIMS)
    (held,) = holdings.steps.values()
    assert [words for words, _ in held.shares] == [TOP, FREE]
    assert [share for _, share in held.shares] == pytest.approx([0.75, 0.25])
    assert held.begin == pytest.approx(0.98)


def test_levels_and_holds_follow_from_events() -> None:
    holdings = HoldTallies([])
    over = LoopEvent(time=1.0, kind=EventKind.OVER, text="")
    hold = LoopEvent(time=1.0, kind=EventKind.HOLD, text="")
    holdings.add(cycle(events=(over, hold)), AIMS)
    assert (holdings.level, holdings.steps[1].holds) == (AlarmLevel.OVER, 1)
    holdings.add(cycle(), AIMS)
    assert holdings.level is AlarmLevel.OVER


def test_ends_are_those_that_the_loop_keeps(control_run: ControlRun) -> None:
    advice, _ = control_run.steps[-1]
    assert advice is not None
    ends = ends_of(advice)
    assert ends.ceiling[0] == ends.reference.ceiling
    assert ends.floor[0] == ends.reference.floor
    assert ends.ceiling[1] in {"feed per tooth", "feed mechanism", "roughness"}
