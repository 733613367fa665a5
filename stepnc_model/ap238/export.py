"""A program of ISO 14649 as an AP238 file, built along the reference paths.

What the table has no path for is left out and listed, so that nothing gets lost silently.

Values that the AIM requires and that a program of ISO 14649 does not have.

References
----------
.. [1] ISO 10303-238, edition 3, schema ``model_based_integrated_manufacturing_schema``.
.. [2] ISO 10303-238, AIM EXPRESS expanded listing: attributes that are not optional.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from stepnc_model.ap238.body_transfer import BODY, CONTEXT, ITEMS, Carried, carried, with_bodies
from stepnc_model.ap238.building import Builder, Unsayable
from stepnc_model.ap238.drafting import AimDraft
from stepnc_model.ap238.instances import Instances, references
from stepnc_model.ap238.requirements import SCHEMA
from stepnc_model.ap238.table import rules
from stepnc_model.ap238.writing import hang, loose_numbers
from stepnc_model.errors import Finding, FindingList, SchemaError, Severity
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Real, Ref, Typed
from stepnc_model.part21.writer import described_as

_QUALIFIED = "QUALIFIED_REPRESENTATION_ITEM"
_SURFACE = "surface_condition"
"""Name of the property that a surface texture is."""


def complete(draft: AimDraft) -> None:
    """Give the new instances of a draft what the AIM requires of them."""
    for id in list(draft.made()):
        if draft.is_a(id, "MACHINING_CUTTING_COMPONENT"):
            _complete_edge(draft, id)
        elif draft.is_a(id, "MAKE_FROM_USAGE_OPTION"):
            draft.set(id, "quantity", Ref(_one(draft)))
        elif draft.is_a(id, "DOCUMENT"):
            draft.set(
                id, "kind", Ref(draft.shared(("DOCUMENT_TYPE",), {"product_data_type": ""}))
            )
        elif draft.is_a(id, "MATERIAL_PROPERTY_REPRESENTATION"):
            property_ = draft.shared(("GENERAL_PROPERTY",), {"name": "material property"})
            draft.set(id, "definition", Ref(property_))
            environment = draft.make(("DATA_ENVIRONMENT",), {"elements": (Ref(id),)})
            draft.set(id, "dependent_environment", Ref(environment))
        elif draft.is_a(id, "REPRESENTATION_RELATIONSHIP"):
            origin = _origin_representation(draft)
            draft.set(id, "rep_1", Ref(origin))
            draft.set(id, "rep_2", Ref(origin))
        elif draft.is_a(id, "ITEM_DEFINED_TRANSFORMATION"):
            draft.set(id, "transform_item_1", Ref(_origin(draft)))
        elif draft.get(id, "name") == _SURFACE and draft.is_a(id, "PROPERTY_DEFINITION"):
            general = draft.shared(("GENERAL_PROPERTY",), {"name": _SURFACE})
            draft.make(
                ("GENERAL_PROPERTY_ASSOCIATION",),
                {"base_definition": Ref(general), "derived_definition": Ref(id)},
            )
        elif draft.is_a(id, _QUALIFIED) and draft.get(id, "qualifiers") is None:
            draft.drop_entity(id, _QUALIFIED)


def _complete_edge(draft: AimDraft, id: int) -> None:
    """Let a cutting edge be used where its tools are."""
    for relation in draft.made():
        if not draft.is_a(relation, "ACTION_RESOURCE_RELATIONSHIP"):
            continue
        if draft.get(relation, "related_resource") != Ref(id):
            continue
        tool = draft.get(relation, "relating_resource")
        users = references(draft.get(int(tool), "usage")) if isinstance(tool, Ref) else ()
        for user in users:
            draft.append(id, "usage", int(user))


def _one(draft: AimDraft) -> int:
    """Count of one."""
    return draft.shared(
        ("MEASURE_WITH_UNIT",),
        {
            "value_component": Typed("COUNT_MEASURE", Real(1.0)),
            "unit_component": Ref(draft.unit("count")),
        },
    )


def _origin(draft: AimDraft) -> int:
    """Placement at the origin."""
    point = draft.shared(
        ("CARTESIAN_POINT",), {"name": "origin", "coordinates": (Real(0.0),) * 3}
    )
    return draft.shared(
        ("AXIS2_PLACEMENT_3D",), {"name": "orientation", "location": Ref(point)}
    )


def _origin_representation(draft: AimDraft) -> int:
    """Shape whose only item is the placement at the origin."""
    context = next(id for id in draft.made() if draft.is_a(id, "GLOBAL_UNIT_ASSIGNED_CONTEXT"))
    return draft.shared(
        ("SHAPE_REPRESENTATION",),
        {"items": (Ref(_origin(draft)),), "context_of_items": Ref(context)},
    )


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
