"""Supervision of axes and readings: what the loop can no longer do is reported.

Pure functions of a state and a reading, as those of :mod:`controller.states.loop_state`.
"""

from controller.monitoring import overload
from controller.orders import EventKind
from controller.signals.signal import Revolution
from controller.states.following import Following, followed
from controller.states.loop_state import LoopState, with_event
from controller.states.phase import Phase
from simulator.reading import Reading
from stepnc_model.units import ms_from_seconds

_WITHOUT_EFFECT = Phase.OFF, Phase.INHIBITED


def supervised(state: LoopState, reading: Reading) -> LoopState:
    """Report axes that do not run the commanded override, and that they do so again."""
    if state.phase in _WITHOUT_EFFECT:
        return state._replace(following=Following(modelled=reading.override))
    before = state.following
    now = followed(before, reading, state.override, lag=state.settings.servo_lag)
    state = state._replace(following=now)
    if now.is_astray and not before.is_astray:
        text = (
            f"{100.0 * state.override:.3g} % commanded, {100.0 * reading.override:.3g} % run "
            f"for {now.astray:.3g} s: the override has no effect"
        )
        return with_event(state, EventKind.ASTRAY, text)
    if before.is_astray and not now.is_astray:
        return with_event(state, EventKind.FOLLOWED, f"again, after {before.astray:.3g} s")
    return state


def resolved(state: LoopState, reading: Reading, revolution: Revolution) -> LoopState:
    """Report whether single teeth can be seen in the readings, when this changes."""
    by_teeth = revolution.by_teeth
    if by_teeth is state.by_teeth:
        return state
    state = state._replace(by_teeth=by_teeth, shares=overload.fresh(reading.teeth))
    text = "readings are tooth periods: broken teeth are looked for"
    if not by_teeth:
        tooth = 1.0 / (reading.spindle_speed * reading.teeth)
        text = (
            f"readings of {ms_from_seconds(reading.period):.3g} ms where a tooth takes "
            f"{ms_from_seconds(tooth):.3g} ms: forces are means over a turn or more, broken "
            "teeth are not looked for, and an overload is noticed no sooner than a reading"
        )
    return with_event(state, EventKind.AVERAGED, text)
