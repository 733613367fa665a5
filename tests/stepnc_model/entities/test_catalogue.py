"""Keywords of both editions of ISO 14649 lead to entities."""

import pytest

from stepnc_model.entities.adaptive import AdaptiveMillingTechnology
from stepnc_model.entities.catalogue import class_of, classes
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.features import MachiningFeature
from stepnc_model.entities.geometry import ElementarySurface, Plane
from stepnc_model.entities.milling import BidirectionalMilling, UnidirectionalMilling
from stepnc_model.entities.operations import MachiningOperation
from stepnc_model.entities.technology import MillingTechnology
from stepnc_model.entities.tools import MillingCuttingTool, MillingToolDimension


@pytest.mark.parametrize(
    ("draft", "standard", "cls"),
    [
        ("TOOL_DIMENSION", "MILLING_TOOL_DIMENSION", MillingToolDimension),
        ("BIDIRECTIONAL", "BIDIRECTIONAL_MILLING", BidirectionalMilling),
        ("UNIDIRECTIONAL", "UNIDIRECTIONAL_MILLING", UnidirectionalMilling),
        ("CUTTING_TOOL", "MILLING_CUTTING_TOOL", MillingCuttingTool),
    ],
)
def test_both_editions_name_one_entity(draft: str, standard: str, cls: type[Entity]) -> None:
    assert classes()[draft] is classes()[standard] is cls


def test_plane_is_an_elementary_surface() -> None:
    assert issubclass(Plane, ElementarySurface)
    assert {"PLANE", "ELEMENTARY_SURFACE"} <= classes().keys()


@pytest.mark.parametrize("cls", [Entity, MachiningOperation, MachiningFeature])
def test_abstract_entities_have_no_keyword(cls: type[Entity]) -> None:
    assert cls not in classes().values()


def test_proposed_technology_is_told_by_its_arity() -> None:
    assert class_of("MILLING_TECHNOLOGY", 5) is AdaptiveMillingTechnology
    assert class_of("MILLING_TECHNOLOGY", 9) is MillingTechnology
    assert class_of("NO_SUCH_ENTITY", 1) is None
