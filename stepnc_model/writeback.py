"""Advice → edits of the file, in one of the profiles. The original file is sacred.

``optimisation`` (default)
    the record as entities, referred to by one surplus parameter at the end of the operation;
``standard``
    the record as prefixed parameters of a copy of the operation's machine functions, which a
    strict ISO 14649 reader takes.

In both the operation's own technology carries the feed. A technology that several operations
share is copied before it is edited. Records that are already there are taken out first, so
that writing the same advice twice gives the same bytes. Only parameters that change, and lines
that are added or removed, differ from the file that was read.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any, cast

from stepnc_model.binding import to_parameters
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.measures import DescriptiveParameter, NumericParameter
from stepnc_model.entities.technology import ProcessModel, ProcessModelList
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.part21.values import Real, Ref, Value
from stepnc_model.part21.writer import Edits
from stepnc_model.program import Program, Workingstep
from stepnc_model.record import (
    GENERATOR,
    PREFIX,
    Record,
    parameters_of,
    read_entities,
    read_parameters,
    write_entities,
)
from stepnc_model.technology import Number, Programmed

SCHEMA = "OPTIMISATION_SCHEMA"
DIGITS = 12
"""significant digits of a number written into the file"""

ORIGINAL = "machine_functions"
"""parameter that names the machine functions a record's copy was made of"""

RECORD_KEYWORDS = frozenset({
    "TIME_CRITICAL_OPTIMISATION",
    "QUALITY_CRITICAL_OPTIMISATION",
    "ENERGY_CRITICAL_OPTIMISATION",
    "OPTIMISATION_RECORD",
    "MACHINE_POWER",
    "MAIN_CUTTING_POWER",
    "CUTTING_FORCE",
    "FACE_MILLING_TYPE",
    "PREDICTED_VALUES",
    "PROGRAMMED_VALUES",
    "NUMERIC_PARAMETER",
})
"""instances that a record is made of"""


class Profile(StrEnum):
    """Where a record goes."""

    OPTIMISATION = "optimisation"
    STANDARD = "standard"


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """What is written for one workingstep."""

    workingstep: Workingstep
    programmed: Programmed
    record: Record
    feed: float
    """number for the file's feed attribute"""
    speed: float | None = None
    """number for the file's speed attribute; ``None``: unchanged"""
    depth: float | None = None
    """mm of one pass; ``None``: unchanged"""


def write(program: Program, changes: Sequence[Change], profile: Profile) -> bytes:
    """The file with the advice in it.

    Parameters
    ----------
    program : Program
        As it was read.
    changes : sequence of Change
    profile : Profile

    Returns
    -------
    bytes
    """
    writer = _Writer(program)
    previous = [writer.take_out(change.workingstep) for change in changes]
    for change in changes:
        writer.edit_conditions(change)
    for change, old in zip(changes, previous, strict=True):
        record = _with_first_programmed(change.record, old)
        writer.put_in(change.workingstep, record, profile)
    return writer.finish()


def convert(program: Program, profile: Profile) -> bytes:
    """The same program with all its records in one profile."""
    writer = _Writer(program)
    taken = [(step, writer.take_out(step)) for step in program.workingsteps]
    for step, record in taken:
        if record is not None:
            writer.put_in(step, record, profile)
    return writer.finish()


def records(program: Program) -> dict[int, Record]:
    """Records of a program, whatever their profile, by the id of their operation."""
    writer = _Writer(program)
    found = {int(step.operation_ref): writer.take_out(step) for step in program.workingsteps}
    return {number: record for number, record in found.items() if record is not None}


def rounded(value: float) -> float:
    """A number with the digits that are written."""
    return float(f"{value:.{DIGITS}g}")


class _Writer:
    """Edits of one file; running state until they are applied."""

    def __init__(self, program: Program) -> None:
        self._program = program
        self._edits = Edits(program.file)
        self._uses: Counter[int] | None = None
        self._mine: dict[tuple[int, str], Ref[Any]] = {}
        self._kept = 0
        self._taken: set[int] = set()

    def take_out(self, step: Workingstep) -> Record | None:
        """Remove the record of a workingstep; what it said, or None."""
        operation = int(step.operation_ref)
        if operation in self._taken:
            return None
        self._taken.add(operation)
        return self._take_entities(step) or self._take_parameters(step)

    def put_in(self, step: Workingstep, record: Record, profile: Profile) -> None:
        """Add the record of a workingstep."""
        operation = int(step.operation_ref)
        self._kept += profile is Profile.OPTIMISATION
        if profile is Profile.OPTIMISATION:
            self._edits.append_parameter(operation, write_entities(record, self._edits))
            self._edits.add_schema(SCHEMA)
        else:
            self._put_parameters(step, record)

    def edit_conditions(self, change: Change) -> None:
        """Feed, speed and depth of a workingstep."""
        step = change.workingstep
        self._edit_number(step, change.programmed.feed, change.feed)
        if change.speed is not None:
            self._edit_number(step, change.programmed.speed, change.speed)
        if change.depth is not None:
            self._edit_depth(step, rounded(change.depth))

    def finish(self) -> bytes:
        """The bytes of the edited file."""
        if not self._kept and not self._has_other_records():
            self._edits.remove_schema(SCHEMA)
        return self._edits.apply()

    def _has_other_records(self) -> bool:
        """Whether entities of records stay in the file."""
        keywords = (name for name in RECORD_KEYWORDS if name.endswith("OPTIMISATION"))
        ids = (number for name in keywords for number in self._program.file.ids_of(name))
        return any(number in self._edits for number in ids)

    def _edit_number(self, step: Workingstep, number: Number, value: float) -> None:
        """One programmed number, in an instance that only this operation uses."""
        program = self._program
        if rounded(value) == rounded(number.in_file(number.value)):
            return
        holder = self._own(step.operation_ref, "its_technology")
        if number.ref != step.technology_ref:
            attribute = _attribute_of(program.get(step.technology_ref), number.ref)
            holder = self._own(step.technology_ref, attribute, within=holder)
        place = program.model.position(number.ref, number.attribute)
        self._edits.replace_parameter(int(holder), place, Real(rounded(value)))

    def _edit_depth(self, step: Workingstep, depth: float) -> None:
        """Depth of one pass: of the operation, or of a turning operation's strategy."""
        program = self._program
        operation = step.operation
        if isinstance(operation, TurningMachiningOperation):
            reference = operation.its_machining_strategy
            if reference is None:
                return
            strategy = self._own(step.operation_ref, "its_machining_strategy")
            place = program.model.position(reference, "cutting_depth")
            self._edits.replace_parameter(int(strategy), place, (Real(depth),))
        elif hasattr(operation, "axial_cutting_depth"):
            place = program.model.position(step.operation_ref, "axial_cutting_depth")
            self._edits.replace_parameter(int(step.operation_ref), place, Real(depth))

    def _own(
        self, owner: Ref[Entity], attribute: str, within: Ref[Any] | None = None
    ) -> Ref[Any]:
        """The instance that an attribute refers to, copied first when others use it too.

        ``within`` is where the owner's parameters are written, when it was itself copied.
        """
        program = self._program
        holder = within if within is not None else owner
        key = (int(holder), attribute)
        if key in self._mine:
            return self._mine[key]
        reference: Ref[Any] = getattr(program.get(owner), attribute)
        uses = self._use_counts()
        mine = reference
        if uses[int(reference)] > 1:
            uses[int(reference)] -= 1
            values = program.file.parameters(int(reference))
            mine = cast(
                "Ref[Any]", self._edits.add(program.file.keyword(int(reference)), values)
            )
            place = program.model.position(owner, attribute)
            self._edits.replace_parameter(int(holder), place, mine)
        self._mine[key] = mine
        return mine

    def _use_counts(self) -> Counter[int]:
        """How many references each instance has in the file."""
        if self._uses is None:
            file = self._program.file
            self._uses = Counter(
                int(reference)
                for number in file.ids()
                for _, values in file.parts(number)
                for reference in _references(values)
            )
        return self._uses

    def _take_entities(self, step: Workingstep) -> Record | None:
        """Remove a record written as entities."""
        program, operation = self._program, int(step.operation_ref)
        reference = step.operation.its_optimisation
        if reference is None:
            return None
        record = read_entities(program.model, reference)
        place = program.model.position(step.operation_ref, "its_optimisation")
        self._edits.remove_parameter(operation, place)
        for number in _record_instances(program, reference):
            if number in self._edits:
                self._edits.remove(number)
        return record

    def _take_parameters(self, step: Workingstep) -> Record | None:
        """Remove a record written as parameters, with the copy of the machine functions."""
        program = self._program
        if step.functions_ref is None:
            return None
        functions: Any = program.get(step.functions_ref)
        values: dict[str, float | str] = {}
        instances = []
        for reference in getattr(functions, "other_functions", None) or ():
            parameter: Any = program.model.entity(int(reference))
            name = getattr(parameter, "parameter_name", "")
            if name.startswith(PREFIX):
                values[name.removeprefix(PREFIX)] = _value_of(parameter)
                instances.append(int(reference))
        original = str(values.pop(ORIGINAL, ""))
        if not original.startswith("#") or int(original[1:]) not in program.file:
            return None
        place = program.model.position(step.operation_ref, "its_machine_functions")
        self._edits.replace_parameter(int(step.operation_ref), place, Ref(int(original[1:])))
        for number in (*instances, *_own_models(program, functions), int(step.functions_ref)):
            if number in self._edits:
                self._edits.remove(number)
        return read_parameters(values)

    def _put_parameters(self, step: Workingstep, record: Record) -> None:
        """Copy the machine functions and add the record to the copy."""
        program, operation = self._program, step.operation_ref
        original = self._original_functions(step)
        functions: Any = program.get(original)
        named = DescriptiveParameter(
            parameter_name=PREFIX + ORIGINAL, descriptive_string=repr(original)
        )
        entities: list[Entity] = [*parameters_of(record), named]
        added = [self._edits.add(entity.keyword, to_parameters(entity)) for entity in entities]
        values = list(program.file.parameters(int(original)))
        place = program.model.position(original, "other_functions")
        values[place] = (*(functions.other_functions or ()), *added)
        model_place = program.model.position(original, "its_process_model")
        if values[model_place] is None:
            values[model_place] = self._process_model(record)
        copy = self._edits.add(program.file.keyword(int(original)), tuple(values))
        at = program.model.position(operation, "its_machine_functions")
        self._edits.replace_parameter(int(operation), at, copy)

    def _original_functions(self, step: Workingstep) -> Ref[Any]:
        """Machine functions of the operation without our record."""
        functions: Any = self._program.get(cast("Ref[Any]", step.functions_ref))
        for reference in getattr(functions, "other_functions", None) or ():
            parameter: Any = self._program.model.entity(int(reference))
            if getattr(parameter, "parameter_name", "") == PREFIX + ORIGINAL:
                return Ref(int(parameter.descriptive_string[1:]))
        return cast("Ref[Any]", step.functions_ref)

    def _process_model(self, record: Record) -> Ref[Any]:
        """A process model that says which model the record comes from."""
        model = ProcessModel(ini_data_file=record.machine, its_type=GENERATOR)
        single = cast("Ref[Any]", self._edits.add(model.keyword, to_parameters(model)))
        models = ProcessModelList(its_list=(single,))
        return cast("Ref[Any]", self._edits.add(models.keyword, to_parameters(models)))


def _with_first_programmed(record: Record, old: Record | None) -> Record:
    """A new record that remembers what the file said before it was ever optimised."""
    if old is None:
        return record
    return replace(
        record,
        programmed_feedrate=old.programmed_feedrate,
        programmed_feedrate_per_tooth=old.programmed_feedrate_per_tooth,
        programmed_cutspeed=old.programmed_cutspeed,
        programmed_spindle=old.programmed_spindle,
        programmed_axial_depth=old.programmed_axial_depth,
    )


def _attribute_of(entity: Entity, ref: Ref[Any]) -> str:
    """Name of the attribute that holds a reference."""
    names = entity.__dataclass_fields__
    return next(name for name in names if getattr(entity, name) == ref)


def _references(values: tuple[Value, ...]) -> Iterator[Ref[object]]:
    """All references among values, lists included."""
    for value in values:
        if isinstance(value, Ref):
            yield value
        elif isinstance(value, tuple):
            yield from _references(value)


def _record_instances(program: Program, ref: Ref[Any]) -> list[int]:
    """Instances that a record is made of, the optimisation first."""
    found, waiting = [], [int(ref)]
    while waiting:
        number = waiting.pop()
        known = number in program.file and number not in found
        if not known or program.file.keyword(number) not in RECORD_KEYWORDS:
            continue
        found.append(number)
        waiting += [int(each) for each in _references(program.file.parameters(number))]
    return found


def _own_models(program: Program, functions: Entity) -> list[int]:
    """Process models of a copy that this project added."""
    reference: Any = getattr(functions, "its_process_model", None)
    models: Any = program.model.entity(int(reference)) if reference is not None else None
    if not isinstance(models, ProcessModelList):
        return []
    kinds = [program.get(each).its_type for each in models.its_list]
    return [int(reference), *map(int, models.its_list)] if kinds == [GENERATOR] else []


def _value_of(parameter: Entity) -> float | str:
    """Number or text of a parameter."""
    if isinstance(parameter, NumericParameter):
        return float(parameter.its_parameter_value)
    return str(getattr(parameter, "descriptive_string", ""))
