"""Conditions of a cut: machine, material, tool grade, work-holding and permitted values.

Work-holding of a setup, taken from the user's table or else from the program.

The program gives the bar and the points where it is clamped (ISO 14649-10,
``clamping_positions``). A chuck is assumed to grip the full diameter of the bar, from the
frontmost clamping point to its end. The machine functions of an operation state whether a
tailstock or a rest supports the bar. Units: mm.
"""

from dataclasses import dataclass

from simulator.errors import LibraryError
from simulator.physics.holding import GripSize
from simulator.spec import (
    CuttingMaterial,
    Machine,
    ToolGrade,
    ToolKind,
    WorkMaterial,
)
from simulator.tools.tool_table import grade_for
from simulator.work_holding import (
    Chuck,
    Holding,
)
from stepnc_model.editing.record_edit import NO_LIMITS, RecordLimits
from stepnc_model.entities.executables import Setup
from stepnc_model.entities.turning import Facing, TurningMachineFunctions
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program, ResolvedWorkingstep, Stock
from stepnc_model.toolpath.task import clamps_of, stock_of


@dataclass(frozen=True, slots=True, kw_only=True)
class BarGrip:
    """Grip of a chuck on a bar, along z of the setup."""

    size: GripSize
    face: float
    """z coordinate of the outer end of the jaws, mm."""
    front: float
    """z of the free end of the bar as bought, mm."""
    has_tailstock: bool = False
    has_rest: bool = False
    """Whether a steady rest or a follow rest also supports the bar."""

    @property
    def overhang(self) -> float:
        """Overhang: length of the bar in front of the jaws, mm."""
        return max(0.0, self.front - self.face)

    @property
    def slenderness(self) -> float:
        """Slenderness L/D of the clamped bar."""
        return self.overhang / self.size.diameter


def holding_of(program: Program, setup: Ref[Setup] | None, machine: Machine) -> Holding | None:
    """Work-holding of a setup: the table that names it, else the table without a setup name."""
    name = setup_id(program, setup).casefold()
    found = {holding.setup.casefold(): holding for holding in machine.holdings}
    return found.get(name) or found.get("")


def setup_id(program: Program, setup: Ref[Setup] | None) -> str:
    """Return the id of a setup; empty without a setup."""
    return str(program.get(setup).its_id).strip() if setup is not None else ""


def grip_of(program: Program, step: ResolvedWorkingstep, chuck: Chuck | None) -> BarGrip | None:
    """Return where the bar of a workingstep is gripped; None if unknown and no chuck is given.

    Raises
    ------
    LibraryError
        When a chuck is given, and neither its table nor the program states where it grips.
    """
    stock = _stock(program, step)
    told = chuck or Chuck(clamping_force=0.0, friction=0.0, source="")
    clamps = [point[2] for point in clamps_of(program, step.setup)]
    face = max(clamps, default=None) if told.jaw_face is None else told.jaw_face
    length, diameter = told.grip_length, told.grip_diameter
    if length is None and stock is not None and face is not None:
        length = face - stock.low[2]
    if diameter is None and stock is not None and stock.radius is not None:
        diameter = 2.0 * stock.radius
    found = {"jaw_face_z_mm": face, "grip_length_mm": length, "grip_diameter_mm": diameter}
    missing = next((key for key, value in found.items() if value is None), "")
    if length is not None and length <= 0.0:
        missing = "grip_length_mm"
    if missing or face is None or length is None or diameter is None or stock is None:
        if chuck is not None:
            raise _missing(program, missing or "jaw_face_z_mm")
        return None
    functions = _functions(program, step)
    has_tailstock = bool(functions and functions.tail_stock)
    if told.has_tailstock is not None:
        has_tailstock = told.has_tailstock
    return BarGrip(
        size=GripSize(diameter=diameter, length=length),
        face=face,
        front=stock.high[2],
        # A tailstock centre occupies the end face, so a facing operation cannot use it.
        has_tailstock=has_tailstock and not isinstance(step.operation, Facing),
        has_rest=bool(functions and (functions.steady_rest or functions.follow_rest)),
    )


def grip_of_bar(chuck: Chuck, bar: Stock) -> BarGrip:
    """Return where a chuck grips a bar of which only the raw part is known.

    Raises
    ------
    LibraryError
        When neither the chuck's table nor the bar states where it grips.
    """
    face = chuck.jaw_face
    length = face - bar.low[2] if face is not None else None
    length = length if chuck.grip_length is None else chuck.grip_length
    diameter = 2.0 * bar.radius if bar.radius is not None else None
    diameter = diameter if chuck.grip_diameter is None else chuck.grip_diameter
    found = {"jaw_face_z_mm": face, "grip_length_mm": length, "grip_diameter_mm": diameter}
    missing = next(
        (
            key
            for key, value in found.items()
            if value is None or (key != "jaw_face_z_mm" and value <= 0.0)
        ),
        "",
    )
    if missing or face is None or length is None or diameter is None:
        text = "missing; NC code and its stock do not state it"
        raise LibraryError(text, path="", key=f"holding.{missing}")
    return BarGrip(
        size=GripSize(diameter=diameter, length=length),
        face=face,
        front=bar.high[2],
        has_tailstock=bool(chuck.has_tailstock),
    )


def _missing(program: Program, key: str) -> LibraryError:
    """Error for a chuck table whose grip cannot be completed from the program."""
    text = f"missing; the bar and clamping positions of {program.name} do not state it"
    return LibraryError(text, path="", key=f"holding.{key}")


def _stock(program: Program, step: ResolvedWorkingstep) -> Stock | None:
    """Return the bar as bought, or None when it cannot be read."""
    try:
        return stock_of(program, step.setup)
    except ValueError:
        return None


def _functions(program: Program, step: ResolvedWorkingstep) -> TurningMachineFunctions | None:
    """Return the turning machine functions of an operation, or None."""
    ref = getattr(step.operation, "its_machine_functions", None)
    found = program.model.entity(int(ref)) if ref is not None else None
    return found if isinstance(found, TurningMachineFunctions) else None


GREATEST_DEFLECTION = 0.1
"""Greatest permitted deflection at the tip of any end mill, mm (customary).

Beyond it the teeth share the work unevenly.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class PermittedDeflection:
    """Permitted deflection of an end mill or bar, with its origin."""

    value: float = GREATEST_DEFLECTION
    """Greatest permitted deflection, mm."""
    origin: str = ""
    """Origin of the value, as the end of a sentence; empty for the customary value."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CuttingConditions:
    """Machine, material, tool grade, work-holding and permitted values of one cut."""

    machine: Machine
    material: WorkMaterial
    cutting_material: CuttingMaterial
    grade: ToolGrade | None
    """Tool with its windows; ``None`` on a machine with only stated limits whose material
    names no group: its source has no tool limits."""
    roughness: float | None
    """Roughness Ra that this surface must keep, mm; None: no requirement."""
    roughness_quantile: float = 0.5
    """Share of surfaces that must keep the roughness; half of them: the median keeps it."""
    finishing_speed: float | None = None
    """Cutting speed of a finished surface, mm/s; None: that of the cut."""
    is_dry: bool = True
    """Whether the cut has no coolant, or it is not known."""
    deflection: PermittedDeflection = PermittedDeflection()
    """Permitted deflection of an end mill from the tolerance or allowance of its wall."""
    force_factor: float = 1.0
    """Accepted correction factor of k_c from measurements."""
    centre_cutting: bool | None = None
    """Whether the end edges of a mill reach its axis; None when unknown."""
    safety_factor: float = 1.0
    """k_c at the planned quantile, relative to the nominal k_c."""
    holding: Holding | None = None
    """Chuck, vice or clamps that hold the workpiece; None: no holding limit applies."""
    bounds: RecordLimits = NO_LIMITS
    """Limits that the record in the file sets."""
    grip: BarGrip | None = None
    """Where the bar is gripped; None when not turned or not stated."""
    bar_deflection: PermittedDeflection | None = None
    """Permitted bending of a bar; None when it is not limited."""


def tool_grade(
    kind: ToolKind, cutting_material: CuttingMaterial, machine: Machine, material: WorkMaterial
) -> ToolGrade | None:
    """Tool with its windows in a material, as a machine takes them.

    The source of a machine with only stated limits may name a material without a group: then
    nothing of the tool is added to it.
    """
    if machine.only_stated_limits and not material.iso_group:
        return None
    return grade_for(kind, cutting_material, material)
