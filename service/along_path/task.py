"""Task of planning feeds along paths, from a request."""

from optimiser.along_path.free_profile import FreeTask
from service.along_path.run import AlongPathTask
from service.requests.advice import AdviceRequest
from simulator.motion.control import control_model
from simulator.motion.segments import axis_limits
from simulator.spec import Machine
from stepnc_model.errors import StepNcError
from stepnc_model.units import speed_from_mm_min


def task_of(request: AdviceRequest, machine: Machine) -> AlongPathTask:
    """Task of planning feeds along paths, as requested.

    Raises
    ------
    StepNcError
        When no control model follows from the machine's axes.
    """
    try:
        control = control_model(request.motion, axis_limits(machine), planner=machine.planner)
    except ValueError as error:
        raise StepNcError(
            f"machine '{machine.name}', control {request.motion.value}: {error}"
        ) from error
    greatest = request.max_feed_mm_min
    return AlongPathTask(
        control=control,
        greatest=None if greatest is None else speed_from_mm_min(greatest),
        levels=request.levels,
        free=FreeTask(has_jerk=request.is_jerk_limited, smooth_share=request.smooth_share),
        margin=request.stock_margin_mm,
        tolerance=request.corner_tolerance_mm,
    )


def least_feed(request: AdviceRequest) -> float:
    """Feed that is allowed on the whole path, mm/s; 0: none.

    Raises
    ------
    StepNcError
        When it exceeds the greatest feed.
    """
    least, greatest = request.least_feed_mm_min, request.max_feed_mm_min
    if least is None:
        return 0.0
    if greatest is not None and least > greatest:
        raise StepNcError(
            f"least feed {least:g} mm/min (--least-feed) is above the greatest feed "
            f"{greatest:g} mm/min (--max-feed)"
        )
    return speed_from_mm_min(least)
