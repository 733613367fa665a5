"""Attributes of simple and complex instances by name, and references backwards."""

import pytest

from stepnc_model.ap238.instances import Instances, references
from stepnc_model.ap238.view import AimView
from stepnc_model.errors import Part21Error
from stepnc_model.part21.values import Ref, Typed, Value
from tests.stepnc_model.ap238.samples import exported, read

TEXT = b"""ISO-10303-21;
HEADER;
ENDSEC;
DATA;
#1=(CHARACTERIZED_OBJECT('','outer diameter')FEATURE_DEFINITION()INSTANCED_FEATURE()
OUTER_ROUND()SHAPE_ASPECT('CONE','outer diameter',#2,.T.));
#2=PRODUCT_DEFINITION_SHAPE('','',#1);
#3=INSTANCED_FEATURE('','toolpath','','toolpath',#2,.F.);
#4=MACHINING_PROCESS_SEQUENCE_RELATIONSHIP('','',#5,#6,2.);
#5=MACHINING_WORKPLAN('PLAN','','','');
#6=MACHINING_WORKINGSTEP('STEP','machining','','');
#7=MACHINING_WORKINGSTEP('BROKEN',,'');
#8=PROPERTY_DEFINITION('x','',#1);
ENDSEC;
END-ISO-10303-21;
"""


def instances() -> Instances:
    """Instances of the file above."""
    return Instances(read(TEXT))


def test_an_attribute_is_found_in_the_part_that_defines_it() -> None:
    assert instances().value(1, "of_shape") == Ref(2)
    assert instances().value(3, "of_shape") == Ref(2)


def test_of_two_supertypes_with_an_attribute_the_last_given_counts() -> None:
    assert instances().values(1, "name") == ("", "CONE")
    assert instances().value(1, "name") == "CONE"


def test_supertypes_are_known_for_simple_and_complex_instances() -> None:
    assert instances().is_a(1, "SHAPE_ASPECT")
    assert instances().is_a(4, "ACTION_METHOD_RELATIONSHIP")
    assert not instances().is_a(4, "ACTION_METHOD")
    assert not instances().is_a(99, "ACTION_METHOD")


def test_instances_that_refer_here_are_found_with_their_subtypes() -> None:
    assert instances().referrers(1, "PROPERTY_DEFINITION", "definition") == [2, 8]
    assert instances().referrers(2, "SHAPE_ASPECT", "of_shape") == [1, 3]
    assert instances().referrers(5, "ACTION_METHOD_RELATIONSHIP", "relating_method") == [4]


def test_a_malformed_instance_is_refused_where_it_is_read() -> None:
    with pytest.raises(Part21Error):
        instances().value(7, "name")
    assert not instances().is_a(7, "ACTION_PROPERTY")


def test_references_are_found_in_lists_and_typed_values() -> None:
    value: Value = (
        Ref(1),
        Typed("LIST_REPRESENTATION_ITEM", (Ref(2), (Ref(3),))),
        "text",
        None,
    )
    assert list(references(value)) == [Ref(1), Ref(2), Ref(3)]


def test_a_view_is_the_same_however_few_instances_stay_parsed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    wanted = AimView.of(read(exported("paper002"))).data
    monkeypatch.setattr("stepnc_model.ap238.instances.MOST_KEPT", 3)
    assert AimView.of(read(exported("paper002"))).data == wanted
