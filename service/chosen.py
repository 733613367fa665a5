"""Machine and material: those that the user names, or those that suit a program."""

from dataclasses import replace
from pathlib import Path

from simulator.errors import SimulationError
from simulator.holding_file import read_holding_file
from simulator.library import load_machine, load_material, machine_names, material_names
from simulator.matching import match_material
from simulator.spec import Certainty, Machine, MachineKind, MaterialMatch, WorkMaterial
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.errors import StepNcError
from stepnc_model.program import Program

DEFAULT_MILL, DEFAULT_LATHE = "vmc15", "lathe22"
"""machines taken when none is named"""


def library_entries(kind: str) -> tuple[Machine | WorkMaterial, ...]:
    """All machines or materials."""
    if kind == "machines":
        return tuple(load_machine(name) for name in machine_names())
    return tuple(load_material(name) for name in material_names())


def library_entry(kind: str, name: str) -> Machine | WorkMaterial:
    """One machine or material, by name or file."""
    if kind == "machines":
        return load_machine(name)
    return load_material_named(name).material


def machine_for(name: str, program: Program) -> Machine:
    """The machine named, or one that suits the program's first workingstep."""
    if name:
        return load_machine(name)
    first = program.workingsteps[0].operation
    is_turning = isinstance(first, TurningMachiningOperation)
    return load_machine(DEFAULT_LATHE if is_turning else DEFAULT_MILL)


def with_holding(machine: Machine, holding: Path | None) -> Machine:
    """A machine with the work-holding of a file; as it is where there is none."""
    if holding is None:
        return machine
    return replace(machine, holdings=read_holding_file(holding, machine.kind))


def material_for(name: str, program: Program) -> MaterialMatch:
    """The material named, or the one the file names."""
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
    """A material by library name, file, or any name that catalogues give it."""
    if name in material_names() or Path(name).suffix == ".toml":
        return MaterialMatch(
            material=load_material(name),
            certainty=Certainty.EXACT,
            reason=f"'{name}' as asked for",
        )
    return match_material((name,))


def require_axes(machine: Machine) -> None:
    """Refuse to run a machine that says nothing of how fast its axes are.

    Raises
    ------
    SimulationError
        With the axes of which nothing is known.
    """
    known = {axis.name for axis in machine.axes}
    needed = {"X", "Z"} if machine.kind is MachineKind.LATHE else {"X", "Y", "Z"}
    if missing := sorted(needed - known):
        text = f"machine '{machine.name}' says nothing of its axes {', '.join(missing)}"
        raise SimulationError(f"{text}: it cannot be run")
