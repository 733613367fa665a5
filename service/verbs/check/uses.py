"""Uses that a program can be put to: tool paths, NC code, simulation and advice.

Each is tried as the command of that name would do it, up to the point where it costs time: a
file that a command refuses is never called usable for it.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

from optimiser.cuts.source import Source, along_paths, from_features
from optimiser.optimise import optimise_program
from optimiser.planning.formulate import OptimisationTask
from service.programs.machine_choice import (
    load_material_named,
    machine_for,
    material_for,
    require_axes,
)
from service.programs.refusals import require_one_channel, require_usable
from simulator.spec import MaterialMatch
from stepnc_model.errors import StepNcError
from stepnc_model.programs.plausibility import refusal
from stepnc_model.programs.program import Program

if TYPE_CHECKING:
    from service.programs.toolpaths import Paths

ANY_MATERIAL = "c45"
"""Material with which a program that names none is tried."""


class UseName(StrEnum):
    """Use of a program."""

    PATHS = "tool paths"
    CODE = "NC code"
    SIMULATION = "simulation"
    ADVICE = "advice"


@dataclass(frozen=True, slots=True, kw_only=True)
class Use:
    """Use of a program, and the reason where it is not possible."""

    name: UseName
    reason: str = ""
    """Reason why it is not possible; empty where it is."""
    is_possible_with_material: bool = False
    """Whether only the name of a material is missing, which the command line can give."""

    @property
    def is_possible(self) -> bool:
        """True if the program can be used so as it is."""
        return not self.reason


def uses_of(program: Program, made: "Paths | StepNcError") -> tuple[Use, ...]:
    """Uses of a program, each with the reason where it is not possible.

    Parameters
    ----------
    made : Paths or StepNcError
        Tool paths of the program, or the reason why they cannot be made.

    Returns
    -------
    tuple of Use
        One for each :class:`UseName`, in their order.
    """
    paths = str(made) if isinstance(made, StepNcError) else ""
    code = str(made) if isinstance(made, StepNcError) else _code(program, made)
    match = _material(program)
    any_match = match if isinstance(match, MaterialMatch) else load_material_named(ANY_MATERIAL)
    missing = match if isinstance(match, str) else ""
    simulation = code or _simulation(program, any_match)
    code = code or _channels(program)
    # What stops a path may stop the advice too; estimates alone would not show it.
    source = along_paths if paths else from_features
    advice = _advice(program, any_match, source)
    return (
        Use(name=UseName.PATHS, reason=paths),
        Use(name=UseName.CODE, reason=code),
        _with_material(UseName.SIMULATION, simulation, missing),
        _with_material(UseName.ADVICE, advice, missing),
    )


def _with_material(name: UseName, reason: str, missing: str) -> Use:
    """Use that needs a material."""
    return Use(
        name=name,
        reason=reason or missing,
        is_possible_with_material=bool(missing and not reason),
    )


def _material(program: Program) -> MaterialMatch | str:
    """Material of a program, or the reason why it is not known."""
    try:
        return material_for("", program)
    except StepNcError as error:
        return str(error)


def _code(program: Program, paths: "Paths") -> str:
    """Reason why no NC code can be written of a program with paths; empty where it can."""
    from service.programs.toolpaths import nc_lines, with_feeds  # noqa: PLC0415 (shapely)
    from stepnc_model.post.dialect import Dialect  # noqa: PLC0415 (with the paths)

    try:
        error = refusal(program, program.workingsteps)
        if error is not None:
            return str(error)
        for _ in nc_lines(with_feeds(paths, keep_going=False), Dialect.LINUXCNC):
            pass
    except StepNcError as error:
        return str(error)
    return ""


def _channels(program: Program) -> str:
    """Reason why code for one channel cannot say what runs; empty where it can."""
    try:
        require_one_channel(program)
    except StepNcError as error:
        return str(error)
    return ""


def _simulation(program: Program, match: MaterialMatch) -> str:
    """Reason why a program with NC code cannot be run; empty where it can."""
    from simulator.machine.tooling import loaded_tool  # noqa: PLC0415 (numpy)

    try:
        require_axes(machine_for("", program))
        for number, ref in enumerate({step.tool_ref for step in program.workingsteps}, 1):
            loaded_tool(program, ref, number, match.material)
    except StepNcError as error:
        return str(error)
    return ""


def _advice(program: Program, match: MaterialMatch, source: Source) -> str:
    """Reason why feeds cannot be advised; empty where they can."""
    try:
        require_usable(program, program.workingsteps, program.findings())
        optimise_program(
            program,
            machine=machine_for("", program),
            material=match,
            task=OptimisationTask(source=source),
        )
    except StepNcError as error:
        return str(error)
    return ""
