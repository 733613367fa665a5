"""Doubts about what a program means: lengths in other units, ids that are there twice.

ISO 14649 knows millimetres only, so that its numbers are read as such. A file that says
otherwise, or whose tools fit their holes only in inches, is read the same way, and warned of.
"""

from collections.abc import Iterator

from stepnc_model.ap238.instances import Instances
from stepnc_model.ap238.quantity import MEASURES, Units, conversion
from stepnc_model.ap238.table import Kind
from stepnc_model.ap238.view import AimView
from stepnc_model.entities.features import RoundHole
from stepnc_model.entities.milling import DrillingTypeOperation
from stepnc_model.errors import Finding, SchemaError, Severity
from stepnc_model.part21.values import Ref
from stepnc_model.program import Program, ResolvedWorkingstep
from stepnc_model.tool import tool_of
from stepnc_model.units import mm_from_inches

CONTEXT = "GLOBAL_UNIT_ASSIGNED_CONTEXT"

ALIKE = 0.01
"""Relative difference up to which a tool in inches is taken for that of its hole."""


def doubts(program: Program) -> Iterator[Finding]:
    """Warnings about what a program may mean otherwise than it is read.

    Parameters
    ----------
    program : Program

    Yields
    ------
    Finding
    """
    yield from _other_lengths(program)
    yield from _same_ids(program)
    for step in program.workingsteps:
        try:
            with program.using(step.operation_ref, step.tool_ref, *step.features):
                finding = _inch_tool(program, step)
        except SchemaError:
            continue
        if finding is not None:
            yield finding


def _other_lengths(program: Program) -> Iterator[Finding]:
    """Warn of units of length that no representation uses, but perhaps the whole file."""
    file = program.file
    if isinstance(file, AimView) or CONTEXT.encode() not in file.data:
        return
    instances = Instances(file)
    units = Units(instances)
    for context in instances.of_entity(CONTEXT):
        used = instances.referrers(context, "REPRESENTATION", "context_of_items")
        factor = conversion(units.length_in(context), MEASURES[Kind.LENGTH]).factor
        if used or factor == 1.0:
            continue
        text = (
            f"gives a unit of length of {factor:g} mm, but ISO 14649 has lengths in mm: the "
            "numbers of the program are read in mm"
        )
        yield program.finding(Severity.WARNING, text, Ref(context))


def _same_ids(program: Program) -> Iterator[Finding]:
    """Warn of different workingsteps with the same id."""
    first: dict[str, ResolvedWorkingstep] = {}
    for step in program.workingsteps:
        other = first.setdefault(step.id, step)
        if other.ref != step.ref:
            text = (
                f"'{step.id}' is also the id of {other.ref}: results that are listed by id do "
                "not tell them apart"
            )
            yield program.finding(Severity.WARNING, text, step.ref, "its_id")


def _inch_tool(program: Program, step: ResolvedWorkingstep) -> Finding | None:
    """Warn of a drill whose diameter is that of its hole in inches."""
    if not isinstance(step.operation, DrillingTypeOperation):
        return None
    diameter = tool_of(program, step.tool_ref).diameter
    for feature in map(program.get, step.features):
        if not isinstance(feature, RoundHole) or feature.diameter is None:
            continue
        hole = program.get(feature.diameter).theoretical_size
        if abs(mm_from_inches(diameter) - hole) <= ALIKE * hole:
            text = (
                f"diameter {diameter:g} mm: in inches it would be that of the hole, {hole:g} mm"
            )
            return program.finding(Severity.WARNING, text, step.tool_ref)
    return None
