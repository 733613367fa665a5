"""Choice of machine and material: named by the user, or suited to the program."""

from dataclasses import replace
from pathlib import Path

from simulator.errors import SimulationError
from simulator.files.holding_file import read_holding_file
from simulator.library import load_machine, load_material, match_material, material_names
from simulator.spec import Certainty, Machine, MachineKind, MaterialMatch
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.errors import SchemaError, StepNcError
from stepnc_model.programs.program import Program

DEFAULT_MILL, DEFAULT_LATHE = "vmc15", "lathe22"
"""Names of the machines used when the user names none."""


def machine_for(name: str, program: Program) -> Machine:
    """Load the named machine, or a default that suits the program's first workingstep.

    Raises
    ------
    StepNcError
        When the machine is not valid, or a default has no workingstep to suit.
    """
    if name:
        return load_machine(name)
    if not program.workingsteps:
        lacking = SchemaError("the program has no machining workingstep")
        raise next(iter(program.faults), lacking)
    first = program.workingsteps[0].operation
    is_turning = isinstance(first, TurningMachiningOperation)
    return load_machine(DEFAULT_LATHE if is_turning else DEFAULT_MILL)


def with_holding(machine: Machine, holding: Path | None) -> Machine:
    """Return a machine with the work-holding read from a file; unchanged without a file."""
    if holding is None:
        return machine
    return replace(machine, holdings=read_holding_file(holding, machine.kind))


def material_for(name: str, program: Program) -> MaterialMatch:
    """Find the material that the user names, or else the one that the STEP-NC file names."""
    if name:
        return load_material_named(name)
    material = program.material()
    if material is None:
        raise StepNcError(
            "the file names no workpiece material: name one with --material "
            "(`stepnc materials` lists them)"
        )
    return match_material((material.standard_identifier, material.material_identifier))


def load_material_named(name: str) -> MaterialMatch:
    """Find a material by library name, file path, or any designation used in catalogues."""
    if Path(name).suffix == ".toml":
        return _as_requested(name)
    return library_material(name)


def library_material(name: str) -> MaterialMatch:
    """Find a material by library name or any designation used in catalogues; never a file.

    Raises
    ------
    UnknownMaterial
        When the library has none.
    """
    return _as_requested(name) if name in material_names() else match_material((name,))


def _as_requested(name: str) -> MaterialMatch:
    return MaterialMatch(
        material=load_material(name),
        certainty=Certainty.EXACT,
        reason=f"'{name}' as requested",
    )


def require_axes(machine: Machine) -> None:
    """Refuse to run a machine whose axis speeds are unknown.

    Raises
    ------
    SimulationError
        With the axes whose data are missing.
    """
    known = {axis.name for axis in machine.axes}
    needed = {"X", "Z"} if machine.kind is MachineKind.LATHE else {"X", "Y", "Z"}
    if missing := sorted(needed - known):
        text = f"machine '{machine.name}' has no data for its axes {', '.join(missing)}"
        raise SimulationError(f"{text}: it cannot be run")
