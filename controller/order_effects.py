"""Effects of the operator's orders on the state of the loop."""

from collections.abc import Sequence
from dataclasses import replace

from controller.equivalent import equivalent
from controller.loop_settings import LoopStep
from controller.loop_state import LoopState, with_bounds, with_event
from controller.orders import CriterionTo, EventKind, MotorPowerTo, Order
from controller.preview import Preview


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
        case _:
            settings = replace(settings, is_on=order.is_on)
            text = "ON" if order.is_on else "OFF: the programmed feed runs"
    state = state._replace(settings=settings, preview=preview, law=None)
    return with_event(with_bounds(state, cap=state.keep.cap), EventKind.ORDER, text)
