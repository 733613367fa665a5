"""A program of ISO 14649 as an AP238 file, built along the reference paths.

What the table has no path for is left out and listed, so that nothing gets lost silently.

References
----------
.. [1] ISO 10303-238, edition 3, schema ``model_based_integrated_manufacturing_schema``.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from stepnc_model.ap238.building import Builder, Unsayable
from stepnc_model.ap238.carrying import BODY, CONTEXT, ITEMS, Carried, carried, with_bodies
from stepnc_model.ap238.completing import complete
from stepnc_model.ap238.drafting import AimDraft
from stepnc_model.ap238.instances import Instances
from stepnc_model.ap238.loose import hang, loose_numbers
from stepnc_model.ap238.requirements import SCHEMA
from stepnc_model.ap238.table import rules
from stepnc_model.errors import Finding, FindingList, SchemaError, Severity
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.writer import described_as


@dataclass(frozen=True, slots=True, kw_only=True)
class Exported:
    """Bytes of an AP238 file, and what could not be said in it."""

    data: bytes
    findings: tuple[Finding, ...]


def to_ap238(file: Part21File) -> Exported:
    """Convert a program of ISO 14649 to AP238.

    Parameters
    ----------
    file : Part21File
        Program of ISO 14649.

    Returns
    -------
    Exported
        The file, with one finding for each attribute and entity that was left out.

    Raises
    ------
    SchemaError
        If the file has neither a project nor a workplan.
    """
    empty = Part21File.from_bytes(described_as(file, [SCHEMA], []), name=file.name)
    instances = Instances(empty)
    draft = AimDraft(empty, instances)
    builder = Builder(file, draft, {})
    roots = [*file.ids_of("PROJECT")] or [*file.ids_of("WORKPLAN")]
    if not roots:
        raise SchemaError("no PROJECT and no WORKPLAN: there is no program to convert")
    for number in roots:
        builder.build(number)
    for rule in rules():
        if rule.is_root:
            for number in file.ids_of(rule.entity.keyword):
                builder.build(number)
    _hang_loose(file, draft, builder)
    complete(draft)
    roots = [number for number in file.ids_of(BODY) if number in builder.built]
    bodies = carried(file, [(number, builder.built[number]) for number in roots])
    findings = FindingList()
    findings.extend(bodies.findings)
    findings.extend(_findings(file, builder, bodies))
    return Exported(data=with_bodies(draft.apply(), bodies), findings=findings.all())


def _hang_loose(file: Part21File, draft: AimDraft, builder: Builder) -> None:
    """Add the parameters to which nothing refers, such as records of an optimisation."""
    built = {number: builder.build(number) for number in loose_numbers(file, file.ids())}
    items = {number: node for number, node in built.items() if node is not None}
    workplans = [number for number in file.ids_of("WORKPLAN") if number in builder.built]
    if items and workplans:
        hang(draft, file, items, builder.built[workplans[0]])


def _findings(file: Part21File, builder: Builder, bodies: Carried) -> Iterator[Finding]:
    """Findings about what was left out, each once."""
    whole = {place.root for place in bodies.places}
    for each in dict.fromkeys(builder.unsayable):
        if each.number not in whole or each.attribute not in (ITEMS, CONTEXT):
            yield _finding(file, each)
    copied = set(bodies.ids)
    for number in file.ids():
        if number not in builder.built and number not in copied:
            each = Unsayable(number=number, attribute="")
            if each not in builder.unsayable:
                yield _finding(file, each, "nothing that AP238 expresses refers to it")


def _finding(file: Part21File, each: Unsayable, message: str = "") -> Finding:
    """Finding about one instance or attribute."""
    is_known = each.number in file
    return Finding(
        severity=Severity.WARNING,
        message=message or "cannot be expressed in AP238 and is left out",
        entity=file.label(each.number) if is_known else f"#{each.number}",
        attribute=each.attribute,
        line=file.line(each.number) if is_known else 0,
        rule="ISO 10303-238",
    )
