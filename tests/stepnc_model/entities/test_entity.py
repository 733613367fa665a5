"""The base of all entities behaves as a frozen dataclass."""

import copy
import pickle
import subprocess
import sys
from dataclasses import FrozenInstanceError, asdict, fields, is_dataclass, replace

import pytest

from stepnc_model.entities.entity import attributes
from stepnc_model.entities.geometry import Axis2Placement3d, Direction
from stepnc_model.entities.milling import Drilling
from stepnc_model.entities.operations import MachiningOperation
from stepnc_model.entities.technology import MillingTechnology, ThreeAxes
from stepnc_model.part21.values import Ref

UP = Direction(name="", direction_ratios=(0.0, 0.0, 1.0))

MEASUREMENT = """
import dataclasses, enum, re, time, typing
import stepnc_model.part21.values
start = time.process_time()
import stepnc_model.entities.catalogue
print(time.process_time() - start)
"""


def test_keyword_follows_from_the_name() -> None:
    assert MillingTechnology.keyword == "MILLING_TECHNOLOGY"
    assert Axis2Placement3d.keyword == "AXIS2_PLACEMENT_3D"
    assert MillingTechnology.express_name() == "milling_technology"


def test_abstract_entity_has_a_name_and_no_keyword() -> None:
    assert MachiningOperation.express_name() == "machining_operation"
    assert not MachiningOperation.keyword


def test_equality_and_hash_go_by_value() -> None:
    same = Direction(name="", direction_ratios=(0.0, 0.0, 1.0))
    assert same == UP
    assert hash(same) == hash(UP)
    assert replace(UP, name="up") != UP
    assert UP != ("", (0.0, 0.0, 1.0))


def test_nothing_can_be_changed() -> None:
    with pytest.raises(FrozenInstanceError):
        UP.name = "down"  # type: ignore[misc]
    with pytest.raises(FrozenInstanceError):
        del UP.name


def test_instances_have_no_dictionary() -> None:
    assert not hasattr(UP, "__dict__")


def test_missing_and_unknown_attributes_are_refused() -> None:
    with pytest.raises(TypeError, match="Direction requires direction_ratios"):
        Direction(name="")  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="Direction has no length"):
        Direction(name="", direction_ratios=(), length=1.0)  # type: ignore[call-arg]


def test_helpers_of_dataclasses_work() -> None:
    assert is_dataclass(UP)
    assert [each.name for each in fields(UP)] == ["name", "direction_ratios"]
    assert asdict(UP) == {"name": "", "direction_ratios": (0.0, 0.0, 1.0)}


@pytest.mark.parametrize("entity", [UP, ThreeAxes()])
def test_entities_can_be_copied_and_sent(entity: object) -> None:
    assert copy.copy(entity) == entity
    assert pickle.loads(pickle.dumps(entity)) == entity


def test_text_form_names_the_attributes() -> None:
    assert repr(UP) == "Direction(name='', direction_ratios=(0.0, 0.0, 1.0))"


def test_optimisation_is_no_express_attribute() -> None:
    assert "its_optimisation" not in attributes(Drilling)
    assert "its_optimisation" in {each.name for each in fields(Drilling)}
    step = Drilling(
        its_id="", its_tool=Ref(1), its_technology=Ref(2), its_machine_functions=Ref(3)
    )
    assert step.its_optimisation is None


def test_all_entities_load_in_the_time_that_help_allows() -> None:
    """Budget 40 ms on a quiet machine; here a bound that only generated code would break."""
    run = subprocess.run(
        [sys.executable, "-c", MEASUREMENT], capture_output=True, text=True, check=True
    )
    assert float(run.stdout) < 0.2
