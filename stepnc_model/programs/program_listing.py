"""Executables of a STEP-NC program in the order in which they run, with level and setup.

Conditions are evaluated and loops are run as often as the file states it. A structure that
leaves open what runs is a fault; what it contains is listed, but does not run.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.executables import (
    Assignment,
    DisplayMessage,
    IfStatement,
    LoadTool,
    MachiningWorkingstep,
    NonSequential,
    OptionalStop,
    Parallel,
    ProgramStop,
    Project,
    RapidMovement,
    Selective,
    SetMark,
    Setup,
    TurningWorkingstep,
    UnloadTool,
    WhileStatement,
    Workplan,
)
from stepnc_model.errors import SchemaError
from stepnc_model.part21.values import Ref
from stepnc_model.programs.binding import Model
from stepnc_model.programs.conditions import ErrorMaker, ProgramVariables

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
    is_open: bool = False
    """Whether it stands in a structure that leaves open what runs."""


@dataclass(frozen=True, slots=True)
class _WalkVisit:
    """Step of the walk: entering an executable, testing a loop again, or leaving it."""

    ref: Ref[Entity]
    level: int
    setup: Ref[Setup] | None
    is_open: bool = False
    is_leaving: bool = False
    is_again: bool = False


class _Walk:
    """Walk through the executables of a program; iterative. Running state."""

    def __init__(self, model: Model, error: ErrorMaker, faults: dict[int, SchemaError]) -> None:
        self.model = model
        self.error = error
        self.faults = faults
        self.variables = ProgramVariables(model, error)
        self.stack = [_WalkVisit(_main_workplan(model, error), 0, None)]
        self.inside: set[int] = set()
        self.count = 0

    def lines(self) -> Iterator[ProgramLine]:
        """Executables in order, structures before their contents."""
        while self.stack:
            visit = self.stack.pop()
            number = int(visit.ref)
            if visit.is_leaving:
                self.inside.discard(number)
                continue
            if number in self.inside and not visit.is_again:
                text = "the program structure contains itself"
                raise self.error(text, visit.ref, "its_elements")
            if number not in self.model.file:
                message = "is referenced, but does not exist in the file"
                self.faults[number] = SchemaError(message, entity=str(visit.ref))
                continue
            self.count += 1
            if self.count > MAX_EXECUTABLES:
                text = f"the program has more than {MAX_EXECUTABLES} executables"
                raise self.error(text, visit.ref)
            yield from self._line(visit, number)

    def _line(self, visit: _WalkVisit, number: int) -> Iterator[ProgramLine]:
        """Line of an executable, and visits of what it contains."""
        # An executable without an entity class is kept and shown.
        entity = self.model.entity(number)
        setup, is_open = visit.setup, visit.is_open
        if isinstance(entity, Workplan):
            setup = entity.its_setup or setup
        if not visit.is_again:
            yield ProgramLine(
                ref=visit.ref,
                keyword=self.model.file.keyword(number),
                id=str(getattr(entity, "its_id", "")),
                level=visit.level,
                setup=setup,
                is_open=is_open,
            )
        try:
            children = _children(entity) if is_open else self._run(entity, visit.ref)
        except SchemaError as fault:
            self.faults[number] = fault
            children, is_open = _children(entity), True
        if children and not visit.is_again:
            self.inside.add(number)
            self.stack.append(_WalkVisit(visit.ref, visit.level, setup, is_leaving=True))
        if children and isinstance(entity, WhileStatement) and not is_open:
            self.stack.append(_WalkVisit(visit.ref, visit.level, setup, is_again=True))
        self.stack.extend(
            _WalkVisit(child, visit.level + 1, setup, is_open) for child in reversed(children)
        )

    def _run(self, entity: Entity | None, ref: Ref[Entity]) -> tuple[Ref[Entity], ...]:
        """Executables of a structure that run, in order.

        Raises
        ------
        SchemaError
            If the file leaves open which ones.
        """
        if isinstance(entity, Assignment):
            self.variables.assign(ref, entity)
        if isinstance(entity, Selective) and len(entity.its_elements) > 1:
            raise self._open_choice(entity, ref)
        if isinstance(entity, IfStatement):
            holds = self.variables.holds(entity.condition, ref)
            branch = entity.true_branch if holds else entity.false_branch
            return () if branch is None else (branch,)
        if isinstance(entity, WhileStatement):
            return _children(entity) if self.variables.holds(entity.condition, ref) else ()
        return _children(entity)

    def _open_choice(self, entity: Selective, ref: Ref[Entity]) -> SchemaError:
        """Error about a choice that the operator has."""
        names = " or ".join(self._named(each) for each in entity.its_elements)
        text = f"one of {names} runs, and the file does not say which"
        first = entity.its_elements[0]
        return self.error(f'{text}; choose it with --set "{ref}.its_elements=({first})"', ref)

    def _named(self, ref: Ref[Entity]) -> str:
        """Executable as messages name it."""
        name = getattr(self.model.entity(int(ref)), "its_id", "")
        return f"{ref} '{name}'" if name else str(ref)


def program_lines(
    model: Model, error: ErrorMaker, faults: dict[int, SchemaError]
) -> Iterator[ProgramLine]:
    """Executables in the order in which they run, structures before their contents.

    Parameters
    ----------
    error : callable
        Makes the error of an instance.
    faults : dict
        Takes the errors of executables that do not exist, or leave open what runs, by number.

    Raises
    ------
    SchemaError
        If there is no main workplan, or the structure contains itself.
    """
    return _Walk(model, error, faults).lines()


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


def is_followed(entity: Entity | None) -> bool:
    """True if tool paths, NC code and simulation follow an executable."""
    return isinstance(entity, (*STRUCTURES, *WITHOUT_MOVES, *FOLLOWED))


STRUCTURES = (Workplan, NonSequential, Selective, Parallel, IfStatement, WhileStatement)
"""Structures, of which the listing has what runs."""

WITHOUT_MOVES = (Assignment, LoadTool, UnloadTool, SetMark)
"""Executables without moves: tools change where a workingstep needs another."""

FOLLOWED = (
    MachiningWorkingstep,
    TurningWorkingstep,
    RapidMovement,
    OptionalStop,
    ProgramStop,
    DisplayMessage,
)
"""Executables with a path or a function of the control."""

_REASONS = {
    "WAIT_FOR_MARK": "another channel sets the mark, and one channel is followed",
    "EXCHANGE_PALLET": "the file does not say what the next pallet holds",
    "INDEX_PALLET": "the file does not say where the workpiece is then",
    "INDEX_TABLE": "the file does not say where the workpiece is then",
}
"""Reasons why a function of the control is not followed, by its EXPRESS name."""


def not_followed(keyword: str) -> str:
    """Reason why paths, NC code, simulation and advice refuse an executable."""
    reason = _REASONS.get(keyword, "this kind of executable cannot be converted to a tool path")
    return f"{reason}; --keep-going leaves it out"
