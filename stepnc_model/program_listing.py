"""Executables of a STEP-NC program in order, each with its nesting level and setup."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

from stepnc_model.binding import Model
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.executables import (
    DisplayMessage,
    IfStatement,
    MachiningWorkingstep,
    NonSequential,
    OptionalStop,
    Parallel,
    ProgramStop,
    Project,
    RapidMovement,
    Selective,
    Setup,
    TurningWorkingstep,
    WhileStatement,
    Workplan,
)
from stepnc_model.errors import SchemaError
from stepnc_model.part21.values import Ref

MAX_EXECUTABLES = 100_000
"""Greatest number of executables; mutually nested workplans could grow without bound."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramLine:
    """Line of a program listing: a program structure, an NC function or a workingstep."""

    ref: Ref[Entity]
    keyword: str
    """EXPRESS name in capitals, as in the file."""
    id: str
    level: int
    """Nesting level, 0 for the main workplan."""
    setup: Ref[Setup] | None
    """Setup of the innermost workplan that has one."""


class ErrorMaker(Protocol):
    """Maker of an error about one instance of a file."""

    def __call__(self, message: str, ref: Ref[Entity], attribute: str = "", /) -> SchemaError:
        """Error with the place of the instance."""
        ...


@dataclass(frozen=True, slots=True)
class _WalkVisit:
    """Step of the walk: entering an executable, or leaving it."""

    ref: Ref[Entity]
    level: int
    setup: Ref[Setup] | None
    is_leaving: bool = False


def program_lines(
    model: Model, error: ErrorMaker, faults: dict[int, SchemaError]
) -> Iterator[ProgramLine]:
    """Executables in order, structures before their contents; iterative.

    Parameters
    ----------
    error : callable
        Makes the error of an instance.
    faults : dict
        Takes the errors of executables that do not exist, by number.

    Raises
    ------
    SchemaError
        If there is no main workplan, or the structure contains itself.
    """
    file = model.file
    stack = [_WalkVisit(_main_workplan(model, error), 0, None)]
    open_ones: set[int] = set()
    count = 0
    while stack:
        visit = stack.pop()
        number = int(visit.ref)
        if visit.is_leaving:
            open_ones.discard(number)
            continue
        if number in open_ones:
            raise error("the program structure contains itself", visit.ref, "its_elements")
        if number not in file:
            message = "is referenced, but does not exist in the file"
            faults[number] = SchemaError(message, entity=str(visit.ref))
            continue
        count += 1
        if count > MAX_EXECUTABLES:
            raise error(f"the program has more than {MAX_EXECUTABLES} executables", visit.ref)
        # An executable without an entity class is kept and shown.
        entity = model.entity(number)
        setup = visit.setup
        if isinstance(entity, Workplan):
            setup = entity.its_setup or setup
        yield ProgramLine(
            ref=visit.ref,
            keyword=file.keyword(number),
            id=str(getattr(entity, "its_id", "")),
            level=visit.level,
            setup=setup,
        )
        children = _children(entity)
        if children:
            open_ones.add(number)
            stack.append(_WalkVisit(visit.ref, visit.level, setup, is_leaving=True))
        stack.extend(_WalkVisit(child, visit.level + 1, setup) for child in reversed(children))


def _main_workplan(model: Model, error: ErrorMaker) -> Ref[Workplan]:
    """Main workplan of the project, or the only workplan that is not nested in another."""
    for ref, project in model.of_type(Project):
        if project.main_workplan is None:
            raise error("the project has no main workplan", ref, "main_workplan")
        if not isinstance(model.get(project.main_workplan), Workplan):
            raise error("is not a workplan", ref, "main_workplan")
        return project.main_workplan
    plans = dict(model.of_type(Workplan))
    inner = {int(element) for plan in plans.values() for element in plan.its_elements}
    outer = [ref for ref in plans if int(ref) not in inner]
    if len(outer) != 1:
        file = model.file
        names = ", ".join(
            f"line {file.line(int(ref))}: {file.label(int(ref))}" for ref in outer[:5]
        )
        raise SchemaError(
            f"no PROJECT, and {len(outer)} workplans that are not nested in another "
            f"({names}): a program needs one main workplan"
        )
    return outer[0]


def _children(entity: Entity | None) -> tuple[Ref[Entity], ...]:
    """Executables contained in a program structure, in order."""
    if isinstance(entity, (Workplan, Selective, NonSequential)):
        return tuple(entity.its_elements)
    if isinstance(entity, Parallel):
        return tuple(entity.branches)
    if isinstance(entity, IfStatement):
        branches = (entity.true_branch, entity.false_branch)
        return tuple(branch for branch in branches if branch is not None)
    if isinstance(entity, WhileStatement):
        return (entity.body,)
    return ()


NOT_FOLLOWED = "this kind of executable cannot be converted to a tool path"
"""Reason why paths, NC code, simulation and advice refuse an executable."""


def is_followed(entity: Entity | None) -> bool:
    """True if tool paths, NC code and simulation follow an executable."""
    return isinstance(
        entity,
        (
            MachiningWorkingstep,
            TurningWorkingstep,
            Workplan,
            NonSequential,
            RapidMovement,
            OptionalStop,
            ProgramStop,
            DisplayMessage,
        ),
    )
