"""The table of reference paths: it fits the entities, the dictionary fits the long form."""

from stepnc_model.ap238.instances import attributes, dictionary, is_a, lineage
from stepnc_model.ap238.table import Kind, PathMove, rules
from stepnc_model.entities.conversion import slots_of
from tests.every_case import every_case
from tests.stepnc_model.ap238.long_form import schema
from tests.stepnc_model.ap238.samples import long_form

WITHOUT_PATH = {
    "ADVANCED_BREP_SHAPE_REPRESENTATION": {"items", "context_of_items"},
    "BORING_TOOL": {"is_adjustable"},
    "CIRCULAR_PATTERN": {"relocated_base_feature", "missing_base_feature"},
    "CUTTING_COMPONENT": {"technological_data", "its_technology"},
    "CUTTING_EDGE_PROPERTIES": {"its_technology", "tool_cutting_edge_angle_type"},
    "MACHINING_WORKINGSTEP": {"its_effect"},
    "MILLING_CUTTING_TOOL": {
        "direction_for_spindle_orientation",
        "tool_holder_diameter_for_spindle_orientation",
    },
    "MILLING_TECHNOLOGY": {"its_adaptive_control"},
    "PROJECT": {"its_owner", "its_release", "its_status"},
    "RECTANGULAR_PATTERN": {"relocated_base_feature", "missing_base_feature"},
    "SURFACE_TEXTURE_PARAMETER": {"parameter_index"},
    "TURNING_TECHNOLOGY": {"its_adaptive_control"},
    "TURNING_WORKINGSTEP": {"its_effect"},
    "WORKPIECE_SETUP": {"its_offset", "its_restricted_area", "its_instructions"},
    "WORKPLAN": {"its_effect"},
}
"""Attributes of mapped entities that have no path; a conversion lists them."""


def test_every_attribute_of_a_mapped_entity_has_a_path_or_is_listed() -> None:
    missing: dict[str, set[str]] = {}
    for rule in rules():
        given = {row.attribute for row in rule.rows}
        left = set(slots_of(rule.entity)) - given
        if left:
            missing.setdefault(rule.entity.keyword, set()).update(left)
    assert missing == WITHOUT_PATH


def test_every_step_names_an_attribute_that_its_entity_has() -> None:
    for rule in rules():
        for row in rule.rows:
            for path in row.paths:
                for step in path.steps:
                    if step.move in (PathMove.BACK, PathMove.USED):
                        assert step.attribute in attributes(step.entity), (rule, row.attribute)
                    for name in step.types + step.made:
                        assert name in dictionary(), name


def test_a_choice_means_members_of_the_enumeration() -> None:
    for rule in rules():
        for row in rule.rows:
            slot = slots_of(rule.entity)[row.attribute]
            for path in row.paths:
                if path.ending.kind is Kind.CHOICE and slot.enumeration is not None:
                    members = {each.value for each in slot.enumeration}
                    assert {iso for _, iso in path.ending.texts} <= members, row.attribute


@every_case("name", sorted(dictionary()))
def test_an_entity_of_the_dictionary_is_that_of_the_long_form(name: str) -> None:
    entities = schema(long_form())
    assert [each.upper() for each in entities.lineage(name.lower())] == list(lineage(name))
    own = [each for each, _ in entities.attributes[name.lower()]]
    assert own == list(dictionary()[name].attributes)


def test_supertypes_count_once_where_they_meet() -> None:
    names = attributes("MACHINING_PROCESS_SEQUENCE_RELATIONSHIP")
    assert names == (
        "name",
        "description",
        "relating_method",
        "related_method",
        "sequence_position",
    )
    assert is_a("MACHINING_PROCESS_SEQUENCE_RELATIONSHIP", "SERIAL_ACTION_METHOD")
