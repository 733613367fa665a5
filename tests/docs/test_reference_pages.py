"""Pages that are made from the code show its errors and the entities of the schema."""

import ast

from docs.hooks.entity_page import CLASSES, entity_page
from docs.hooks.error_page import error_page
from tests.docs.pages import ROOT, section


def test_the_tree_shows_branches_and_attributes() -> None:
    page = error_page(ROOT)
    assert "├── Part21Error(line, column)" in page
    assert "│   └── PathError" in page
    assert "│   ├── Infeasible(limits, station)" in page


def test_numbers_of_entities_have_their_unit() -> None:
    own = section(entity_page(ROOT), "predicted_values")
    assert "| `machining_time` | `time_measure` | s |" in own
    assert "| `motor_power` | `power_measure` | kW, greatest |" in own
    assert (
        "| `surface_roughness` | `roughness_measure`, optional | µm, arithmetic mean |" in own
    )


def test_entities_without_a_remark_take_the_docstring_of_their_class() -> None:
    tree = ast.parse((ROOT / CLASSES).read_text(encoding="utf-8"))
    classes = {each.name for each in tree.body if isinstance(each, ast.ClassDef)}
    assert "MachinePower" in classes
    assert "Power available at the main drive." in section(entity_page(ROOT), "machine_power")
