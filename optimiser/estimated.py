"""Cuts estimated from features alone, for milling, drilling and turning operations.

Also determines what no tool path shows: tool kind, surface texture, whether the workingstep
finishes, and the programmed setting.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from optimiser.conditions import tool_grade
from optimiser.cut import Cut, CutKind, Texture
from optimiser.estimate import FULL_LOAD, INTO_SOLID, hole_cut, is_hole_making, milling_cut
from optimiser.estimate_turning import mean_diameter, turning_cut
from optimiser.problem import Setting
from optimiser.side_by_side import Result, one_by_one
from simulator.edge_material import edge_material
from simulator.spec import CuttingMaterial, Machine, WorkMaterial
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.errors import Finding, Severity
from stepnc_model.program import Program, ResolvedWorkingstep
from stepnc_model.technology import programmed
from stepnc_model.tool import tool_of

GUESSES = frozenset({FULL_LOAD, INTO_SOLID})
"""Messages that no longer apply once the contact along the path is known."""


class Estimates:
    """Source of cuts that are estimated from features, without tool paths."""

    def __init__(self, program: Program, machine: Machine, material: WorkMaterial) -> None:
        self.program = program
        self.machine = machine
        self.material = material

    def cut(self, step: ResolvedWorkingstep) -> tuple[Cut, list[Finding]]:
        """Return the estimated cut of a workingstep as programmed, with findings."""
        return estimated_cut(self.program, step, self.machine, self.material)

    def at(self, _step: ResolvedWorkingstep, cut: Cut, _setting: Setting) -> Cut:
        """Return the cut unchanged: an estimate does not depend on the setting."""
        return cut

    def timed(self, _step: ResolvedWorkingstep, cut: Cut, _setting: Setting) -> Cut:
        """Return the cut unchanged: its length and time are those of one pass."""
        return cut

    def leave_out(self, step: ResolvedWorkingstep) -> None:
        """Do nothing: estimated workingsteps do not affect each other."""

    def each(
        self, steps: Sequence[ResolvedWorkingstep], do: Callable[[ResolvedWorkingstep], Result]
    ) -> Iterator[Result]:
        """Run a function on each workingstep, one after the other, and yield the results."""
        return one_by_one(steps, do)


def estimated_cut(
    program: Program, step: ResolvedWorkingstep, machine: Machine, material: WorkMaterial
) -> tuple[Cut, list[Finding]]:
    """Estimate the cut of a workingstep from its feature; the findings state assumptions.

    Parameters
    ----------
    program : Program
    step : ResolvedWorkingstep
    machine : Machine
    material : WorkMaterial
        Workpiece material; helix and parallel land come from the tool grade, the land unless
        the machine uses only its stated limits.

    Raises
    ------
    SchemaError
        When the workingstep lacks what a cut needs.
    """
    tool = tool_of(program, step.tool_ref)
    conditions = programmed(program, step.technology_ref)
    findings: list[Finding] = []
    operation = step.operation
    is_turning = isinstance(operation, TurningMachiningOperation)
    diameter = mean_diameter(program, step) if is_turning else tool.diameter
    if diameter <= 0.0:
        raise program.error("cuts at the spindle axis: cutting speed 0", step.operation_ref)
    speed = conditions.spindle_speed(diameter)
    feed = conditions.feed_per_tooth(speed, tool.teeth)
    if not is_turning and not tool.has_teeth:
        text = "number_of_teeth is not given: one tooth assumed"
        findings.append(program.finding(Severity.NOTE, text, step.tool_ref))
    if conditions.has_both_speeds:
        text = "cutspeed and spindle are both given (ISO 14649-11 WR1): the spindle counts"
        findings.append(
            program.finding(Severity.WARNING, text, step.technology_ref, "cutspeed")
        )
    make = milling_cut
    if is_turning:
        make = turning_cut
    elif is_hole_making(operation, tool):
        make = hole_cut
    cut, found = make(program, step, tool, speed=speed, feed=feed)
    if cut.kind is CutKind.MILLING:
        cutting_material = edge_material(tool.edge_material) or CuttingMaterial.CARBIDE
        grade = tool_grade(cut.tool_kind, cutting_material, machine, material)
        if grade is not None:
            is_marked = (
                cut.texture is Texture.CORNER_PER_REVOLUTION and not machine.only_stated_limits
            )
            land = grade.parallel_land if is_marked else 0.0
            cut = replace(cut, helix_angle=grade.helix_angle, parallel_land=land)
    return cut, findings + list(found)
