"""Allowance that a given tool path leaves on the walls for later given paths. Unit mm.

A given path states no allowance. Where the paths of later workingsteps on the same feature go
further out on all four sides, down to the same depth, what they go further is left by this one.
"""

from functools import lru_cache

from stepnc_model.entities.milling import FreeformOperation
from stepnc_model.errors import SchemaError
from stepnc_model.program import Program, ResolvedWorkingstep
from stepnc_model.toolpath.generate import workingstep_path
from stepnc_model.toolpath.left_out import TOUCHING, SweptBox, swept_box

PASSES_KEPT = 2048
"""Number of boxes that are remembered: each is compared with those of all later paths."""


def left_by_path(program: Program, step: ResolvedWorkingstep) -> float:
    """Least distance by which later given paths on the same feature go further out, mm.

    Parameters
    ----------
    program : Program
    step : ResolvedWorkingstep
        A workingstep with a given tool path.

    Returns
    -------
    float
        0 where no later path goes further out on all sides, or none as deep.
    """
    own = _box(program, step.index)
    later = [
        box
        for other in program.after(step)
        if isinstance(other.operation, FreeformOperation)
        and other.setup == step.setup
        and (box := _box(program, other.index)) is not None
    ]
    if own is None or not later or min(box.low[2] for box in later) > own.low[2] + TOUCHING:
        return 0.0
    beyond = [own.low[axis] - min(box.low[axis] for box in later) for axis in (0, 1)]
    beyond += [max(box.high[axis] for box in later) - own.high[axis] for axis in (0, 1)]
    return max(0.0, min(beyond))


@lru_cache(maxsize=PASSES_KEPT)
def _box(program: Program, index: int) -> SweptBox | None:
    """Box that the path of a workingstep sweeps; None where no path can be made."""
    try:
        return swept_box(program, workingstep_path(program, program.workingsteps[index]))
    except SchemaError:
        return None
