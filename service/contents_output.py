"""Contents and findings of a STEP-NC file as text and JSON, for the command ``check``."""

from collections.abc import Iterator
from dataclasses import dataclass

from service.contents import Contents
from service.rendering.columns import Column
from service.rendering.records import dump, finding_record, records
from service.rendering.text import YELLOW, print_findings, print_line, print_table
from service.uses import Use
from stepnc_model.program import Program, ResolvedWorkingstep

MOST_INDENTED = 20
"""Deepest level of executables that the table still shows by indentation."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ExecutableRow:
    """Row of the workplan table: one executable with its operation and tool."""

    instance: str
    entity: str
    id: str
    level: int
    operation: str
    tool: str


EXECUTABLES: tuple[Column[ExecutableRow], ...] = (
    Column(key="instance", heading="instance", value=lambda row: row.instance, is_key=True),
    Column(
        heading="executable",
        value=lambda row: "  " * min(row.level, MOST_INDENTED) + row.entity.lower(),
    ),
    Column(key="entity", value=lambda row: row.entity),
    Column(key="id", heading="id", value=lambda row: row.id),
    Column(key="level", value=lambda row: row.level),
    Column(heading="operation", value=lambda row: row.operation),
    Column(heading="tool", value=lambda row: row.tool),
)

STEPS: tuple[Column[ResolvedWorkingstep], ...] = (
    Column(key="id", value=lambda step: step.id),
    Column(key="instance", value=lambda step: str(step.ref)),
    Column(key="operation", value=lambda step: step.operation_type),
    Column(key="tool", value=lambda step: str(step.tool_ref)),
)


def print_contents(contents: Contents) -> None:
    """Print the contents and findings of a STEP-NC file."""
    print_line(
        f"{contents.name}: {contents.instances} instances, "
        f"schemas {', '.join(contents.schemas) or 'none'}"
    )
    if contents.program is not None:
        print_table(EXECUTABLES, list(_executables(contents.program)))
    print_findings(contents.findings, told=contents.remarks)
    if not contents.uses:
        print_line("cannot be used: see the errors above")
        return
    print_line("usable for:")
    for use in contents.uses:
        print_line(f"  {use.name.value}: {_answer(use)}", "" if use.is_possible else YELLOW)


def _answer(use: Use) -> str:
    """Say whether a use is possible, with the reason where it is not."""
    return "yes" if use.is_possible else f"no: {use.reason}"


def _executables(program: Program) -> Iterator[ExecutableRow]:
    steps = {int(step.ref): step for step in program.workingsteps}
    for each in program.executables:
        step = steps.get(int(each.ref))
        yield ExecutableRow(
            instance=str(each.ref),
            entity=each.keyword,
            id=each.id,
            level=each.level,
            operation=step.operation_type if step else "",
            tool=getattr(program.get(step.tool_ref), "its_id", "") if step else "",
        )


def contents_json(contents: Contents) -> str:
    """Return the contents and findings of a STEP-NC file as JSON."""
    program = contents.program
    return dump({
        "program": contents.name,
        "schemas": list(contents.schemas),
        "instances": contents.instances,
        "is_usable": contents.is_usable,
        "uses": [
            {
                "name": use.name.value,
                "is_possible": use.is_possible,
                "is_possible_with_material": use.is_possible_with_material,
                "reason": use.reason,
            }
            for use in contents.uses
        ],
        "executables": records(EXECUTABLES, _executables(program)) if program else [],
        "workingsteps": records(STEPS, program.workingsteps) if program else [],
        "findings": [finding_record(finding) for finding in contents.findings],
    })
