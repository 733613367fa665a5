"""Effects of the operator's orders on the state of the loop."""

from collections.abc import Sequence
from dataclasses import replace

from controller.guard import AllowedOverride, OverrideReason
from controller.orders import (
    CriterionTo,
    EventKind,
    FeedHoldTo,
    MotorPowerTo,
    Order,
    OverrideAtMost,
)
from controller.signals.preview import Preview
from controller.states.equivalent_force import equivalent
from controller.states.loop_settings import LoopStep
from controller.states.loop_state import LoopState, with_bounds, with_event
from controller.states.phase import Phase


def obeyed(
    state: LoopState, order: Order, *, plain: Preview, steps: Sequence[LoopStep]
) -> LoopState:
    """Apply an order of the operator, which the next decision follows.

    Parameters
    ----------
    plain : Preview
        Preview of real forces.
    """
    settings, preview = state.settings, state.preview
    match order:
        case CriterionTo(criterion=criterion):
            settings = replace(settings, criterion=criterion)
            text = f"mode {criterion.value}"
        case MotorPowerTo(factor=factor):
            settings = replace(settings, power_factor=factor)
            preview = equivalent(plain, steps, settings)
            text = f"motor power {100.0 * factor:.4g} %"
        case FeedHoldTo(is_held=is_held):
            settings = replace(settings, is_held=is_held)
            text = "the operator holds the feed" if is_held else "the operator resumes the feed"
        case OverrideAtMost(most=most):
            settings = replace(settings, most=most)
            text = f"override at most {100.0 * most:.4g} %"
        case _:
            settings = replace(settings, is_on=order.is_on)
            text = "ON" if order.is_on else "OFF: the programmed feed runs"
    state = state._replace(settings=settings, preview=preview, law=None)
    return with_event(with_bounds(state, cap=state.keep.cap), EventKind.ORDER, text)


def operated(state: LoopState) -> LoopState:
    """Keep the override within what the operator allows; the guard's own bound stays.

    A workingstep whose override the program inhibits is held, but not slowed down.
    """
    settings, reference = state.settings, state.step.reference
    if state.phase is Phase.STOPPED:
        return state
    if settings.is_held:
        held = AllowedOverride(override=0.0, holding=OverrideReason.OPERATOR_HOLD)
        return state._replace(allowed=held)
    is_inhibited = bool(reference.workingstep and reference.inhibition)
    if is_inhibited or state.override <= settings.most:
        return state
    slower = AllowedOverride(override=settings.most, holding=OverrideReason.OPERATOR)
    return state._replace(allowed=slower)
