"""Drilling cycles of Klartext by their parameters.

After Heidenhain, "iTNC 530 User's Manual, Cycle Programming".
"""

from collections.abc import Mapping
from math import nan

from stepnc_model.nc.drilling import drilling
from stepnc_model.post.blocks import DrillingCycle
from stepnc_model.toolpath.path import CycleKind

CYCLES = {
    "200": CycleKind.DRILL,
    "201": CycleKind.BORE,
    "203": CycleKind.DRILL,
    "205": CycleKind.DRILL,
    "206": CycleKind.TAP,
    "207": CycleKind.TAP,
    "240": CycleKind.DRILL,
}


def hole_of(
    number: str, values: Mapping[str, float], at: tuple[float, float], *, scale: float
) -> DrillingCycle:
    """Hole that a cycle drills.

    Parameters
    ----------
    number : str
    values : mapping of str to float
        Q parameters of the definition.
    at : tuple of 2 floats, mm
    scale : float, mm
        Length of one unit of the program.
    """
    surface, depth = values.get("Q203", 0.0), values.get("Q201", nan)
    kind, step, above = _kind(number, values)
    return drilling(
        kind,
        at,
        heights=(scale * (surface + values.get("Q200", 0.0)), scale * (surface + depth)),
        step=scale * step,
        above=scale * above,
        dwell=values.get("Q211", 0.0),
    )


def _kind(number: str, values: Mapping[str, float]) -> tuple[CycleKind, float, float]:
    """Kind of a drilling cycle, its peck depth and its retract distance."""
    kind, step = CYCLES[number], values.get("Q202", 0.0)
    if kind is not CycleKind.DRILL:
        return kind, 0.0, nan
    if number == "205" and values.get("Q257"):
        return CycleKind.CHIP_BREAK, values["Q257"], values.get("Q256", nan)
    if step and not step >= -values.get("Q201", nan):
        return CycleKind.PECK, step, values.get("Q258", nan)
    return CycleKind.DWELL if values.get("Q211") else kind, 0.0, nan
