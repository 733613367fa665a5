"""Values that the AIM requires and that a program of ISO 14649 does not have.

References
----------
.. [1] ISO 10303-238, AIM EXPRESS expanded listing: attributes that are not optional.
"""

from stepnc_model.ap238.drafting import AimDraft
from stepnc_model.ap238.instances import references
from stepnc_model.part21.values import Real, Ref, Typed

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
