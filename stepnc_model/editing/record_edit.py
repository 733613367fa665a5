"""Insertion and removal of optimisation records in a draft, and search for records.

In profile ``optimisation``, the record is entities behind one surplus parameter of the
operation. In profile ``standard``, it is prefixed parameters to which no instance refers:
interpreters of programs never meet them. Their names end with the workingstep, as
``optimisation:mode:1:ROUGH THE FACE``: the first workingstep of that id. Earlier versions wrote
them into a copy of the operation's machine functions; such records are read and replaced.

Limits in the optimisation record of a file, which bound the next plan.

Paper 002, Fig. 10, gives an optimisation the power of the main drive and the greatest feed per
tooth and depth that are allowed. A record of that form is an input. A record that this project
wrote binds only by the limits that it took over from one: what it wrote as its own optimum, as
records did before they kept the two apart, never binds. Units mm, W.
"""

from dataclasses import dataclass
from math import isfinite
from typing import Any

from stepnc_model.editing.draft import Draft, references
from stepnc_model.editing.record import (
    GENERATOR,
    PREFIX,
    AdviceRecord,
    parameters_of,
    read_entities,
    read_parameters,
    write_entities,
)
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.measures import NumericParameter
from stepnc_model.entities.optimisation import (
    MachinePower,
    Optimisation,
    OptimisationRecord,
    TimeCriticalOptimisation,
)
from stepnc_model.entities.paper002 import read_printed
from stepnc_model.entities.technology import MachineFunctions, ProcessModelList
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.units import kw_from_watts, watts_from_kw


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordLimits:
    """Limits of one operation; None where the record sets none."""

    motor_power: float | None = None
    """Power that the cut may draw from the main drive, W."""
    feed_per_tooth: float | None = None
    """Greatest feed per tooth, mm."""
    axial_depth: float | None = None
    """Greatest axial depth of one pass, mm."""

    def __bool__(self) -> bool:
        return any(
            value is not None
            for value in (self.motor_power, self.feed_per_tooth, self.axial_depth)
        )

    @property
    def words(self) -> str:
        """Limits with their units."""
        parts = []
        if self.motor_power is not None:
            parts.append(f"motor power {kw_from_watts(self.motor_power):.4g} kW")
        if self.feed_per_tooth is not None:
            parts.append(f"feed per tooth {self.feed_per_tooth:.4g} mm")
        if self.axial_depth is not None:
            parts.append(f"axial depth {self.axial_depth:.4g} mm")
        return ", ".join(parts)


NO_LIMITS = RecordLimits()
"""Limits of a workingstep whose record does not bind."""


def record_limits(program: Program, step: ResolvedWorkingstep) -> RecordLimits:
    """Limits of the optimisation record of a workingstep.

    Returns
    -------
    RecordLimits
        Without values where there is no record, or none that binds.
    """
    own = find_record(program, step)
    if own is not None:
        power = own.machine_power_bound
        return RecordLimits(
            motor_power=None if power is None else watts_from_kw(power),
            feed_per_tooth=own.feed_per_tooth_bound,
            axial_depth=own.axial_depth_bound,
        )
    reference = step.operation.its_optimisation
    found: Any = None if reference is None else program.model.entity(int(reference))
    if not isinstance(found, Optimisation) or _has_details(program, found):
        return NO_LIMITS
    power = _motor_power(program, found)
    if not isinstance(found, TimeCriticalOptimisation):
        return RecordLimits(motor_power=power)
    return RecordLimits(
        motor_power=power,
        feed_per_tooth=_positive(found.feed_per_tooth_max),
        axial_depth=_positive(found.axial_cutting_depth_max),
    )


def _has_details(program: Program, optimum: Optimisation) -> bool:
    """True if an optimisation is one that this project wrote, even if damaged since."""
    reference: Any = getattr(optimum, "its_record", None)
    if reference is None:
        return False
    return isinstance(program.model.entity(int(reference)), OptimisationRecord)


def _motor_power(program: Program, optimum: Optimisation) -> float | None:
    """Power of the main drive, W: as the schema gives it, or as Fig. 11 prints it."""
    reference: Any = optimum.main_drive_motor_power
    number = None if reference is None else int(reference)
    if number is None or number not in program.file:
        return None
    keyword = program.file.keyword(number)
    printed = read_printed(keyword, program.file.parameters(number))
    if printed is not None:
        return _watts(printed.inlined)
    entity: Any = program.model.entity(number)
    if not isinstance(entity, MachinePower):
        return None
    inner: Any = entity.its_power_property
    return _watts(None if inner is None else program.model.entity(int(inner)))


def _watts(parameter: object) -> float | None:
    """Power of a numeric parameter in kW or W; None for any other."""
    if not isinstance(parameter, NumericParameter):
        return None
    value = _positive(parameter.its_parameter_value)
    unit = (parameter.its_parameter_unit or "").strip().upper()
    if value is None or unit not in {"KW", "W"}:
        return None
    return watts_from_kw(value) if unit == "KW" else value


def _positive(value: float | None) -> float | None:
    """Positive finite number; None for any other."""
    return value if value is not None and isfinite(value) and value > 0.0 else None


ORIGINAL = "machine_functions"
"""Name of the parameter that refers to the original of copied machine functions."""

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
"""Keywords of the instances that make up a record."""


def find_record(program: Program, step: ResolvedWorkingstep) -> AdviceRecord | None:
    """Record of a workingstep in either profile; None if there is none."""
    reference = step.operation.its_optimisation
    if reference is not None:
        return read_entities(program.model, reference)
    return _parameter_record(program, step)


def has_parameters(program: Program) -> bool:
    """True if any workingstep has its record in profile ``standard``."""
    return any(_parameter_record(program, step) is not None for step in program.workingsteps)


def take_out(draft: Draft, step: ResolvedWorkingstep) -> None:
    """Remove the optimisation record of an operation in either form."""
    program = draft.program
    reference = step.operation.its_optimisation
    if reference is not None:
        draft.drop_surplus(step.operation_ref)
        draft.remove(_record_instances(program, reference))
    draft.remove([
        int(ref) for refs in _named_parameters(program, step).values() for ref in refs
    ])
    original = _original_functions(program, step)
    if original is None or step.functions_ref is None:
        return
    functions: Any = program.get(step.functions_ref)
    draft.put(step.operation_ref, "its_machine_functions", original)
    ours = [
        int(each)
        for each in functions.other_functions or ()
        if _name_of(program, each).startswith(PREFIX)
    ]
    draft.remove([*ours, *_own_models(program, functions), int(step.functions_ref)])


def put_entities(draft: Draft, step: ResolvedWorkingstep, record: AdviceRecord) -> None:
    """Add a record in profile ``optimisation``."""
    draft.append_surplus(step.operation_ref, write_entities(record, draft.edits))


def put_parameters(draft: Draft, step: ResolvedWorkingstep, record: AdviceRecord) -> None:
    """Add a record in profile ``standard``: parameters to which no instance refers."""
    for entity in parameters_of(record, _key(draft.program, step)):
        draft.add(entity)


def _key(program: Program, step: ResolvedWorkingstep) -> str:
    """Ordinal of a workingstep among those of the same id, and its id."""
    alike = [other for other in program.workingsteps if other.id == step.id]
    place = next(count for count, other in enumerate(alike, 1) if other.ref == step.ref)
    return f"{place}:{step.id}"


def _named_parameters(
    program: Program, step: ResolvedWorkingstep
) -> dict[str, list[Ref[Entity]]]:
    """Parameters of the record of an operation, by the name of their attribute."""
    ours = program.parameters_named(PREFIX)
    if not ours:
        return {}
    found: dict[str, list[Ref[Entity]]] = {}
    for other in program.workingsteps:
        if other.operation_ref != step.operation_ref:
            continue
        ending = f":{_key(program, other)}"
        for name, refs in ours.items():
            attribute = name.removeprefix(PREFIX).removesuffix(ending)
            if name.endswith(ending) and ":" not in attribute:
                found.setdefault(attribute, []).extend(refs)
    return found


def _parameter_record(program: Program, step: ResolvedWorkingstep) -> AdviceRecord | None:
    """Read a record written as parameters, or as parameters of the machine functions."""
    named = _named_parameters(program, step)
    if named:
        return read_parameters({
            name: _value_of(program.get(refs[-1])) for name, refs in named.items()
        })
    if _original_functions(program, step) is None or step.functions_ref is None:
        return None
    functions: Any = program.get(step.functions_ref)
    values: dict[str, float | str] = {}
    for reference in functions.other_functions or ():
        name = _name_of(program, reference)
        if name.startswith(PREFIX):
            values[name.removeprefix(PREFIX)] = _value_of(program.get(reference))
    return read_parameters(values)


def _original_functions(program: Program, step: ResolvedWorkingstep) -> Ref[Any] | None:
    """Original of an operation's copied machine functions; None if it has no copy."""
    if step.functions_ref is None:
        return None
    functions: Any = program.model.entity(int(step.functions_ref))
    for reference in getattr(functions, "other_functions", None) or ():
        if _name_of(program, reference) != PREFIX + ORIGINAL:
            continue
        number = str(_value_of(program.get(reference))).removeprefix("#")
        if not number.isdecimal() or int(number) == int(step.functions_ref):
            return None
        is_functions = isinstance(program.model.entity(int(number)), MachineFunctions)
        return Ref(int(number)) if is_functions else None
    return None


def _record_instances(program: Program, ref: Ref[Any]) -> list[int]:
    """Instances that make up a record, the optimisation first."""
    found, waiting = [], [int(ref)]
    while waiting:
        number = waiting.pop()
        known = number in program.file and number not in found
        if not known or program.file.keyword(number) not in RECORD_KEYWORDS:
            continue
        found.append(number)
        waiting += [int(each) for each in references(program.file.parameters(number))]
    return found


def _own_models(program: Program, functions: Entity) -> list[int]:
    """Process models of copied machine functions that this project added."""
    reference: Any = getattr(functions, "its_process_model", None)
    models: Any = program.model.entity(int(reference)) if reference is not None else None
    if not isinstance(models, ProcessModelList):
        return []
    kinds = [program.get(each).its_type for each in models.its_list]
    return [int(reference), *map(int, models.its_list)] if kinds == [GENERATOR] else []


def _name_of(program: Program, ref: Ref[Any]) -> str:
    """Name of a parameter; empty for other instances."""
    return str(getattr(program.model.entity(int(ref)), "parameter_name", ""))


def _value_of(parameter: Entity) -> float | str:
    """Number or text of a parameter."""
    if isinstance(parameter, NumericParameter):
        return parameter.its_parameter_value
    return str(getattr(parameter, "descriptive_string", ""))
