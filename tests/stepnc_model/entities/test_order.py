"""Every entity has the attributes of the standard, in their order and with their options.

The tables are read in place; where an entity differs on purpose, the difference is listed.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import pytest

from stepnc_model.entities.catalogue import classes
from stepnc_model.entities.conversion import AttributeSlot, slots_of
from stepnc_model.entities.entity import Entity, attributes

TABLES = Path(__file__).parents[4] / "shared" / "design" / "ENTITIES.md"

ARITIES = {
    "RECTANGULAR_PATTERN": 13,
    "TEE_PROFILE": 9,
    "TAPPING": 15,
    "THREAD_DRILLING": 15,
    "COMBINED_DRILL_AND_TAP": 6,
    "BIDIRECTIONAL_CONTOUR": 6,
    "CONTOUR_BIDIRECTIONAL": 6,
}
"""tables without names: one row holds several attributes, the draft of 2001 counts them"""

RENAMED = {
    "SIDE_MILL.length_measure": "cutter_width",  # the table gives the name of the type
    "erretract_plane": "retract_plane",  # misspelt in the XSD
}

LEFT_OUT = {"ref_dt_cutting_tool"}
"""private extension of one vendor's XSD"""

ADDED = {"BORING_TOOL": ("is_adjustable",)}
"""sixth parameter that files have and no edition explains"""

OPTIONAL_HERE = {
    "BIDIRECTIONAL.stepover_direction",  # OPTIONAL has run into the type's name
}

PLAIN = {
    "identifier": str,
    "label": str,
    "text": str,
    "str": str,
    "string": str,
    "boolean": bool,
    "bool": bool,
    "integer": int,
    "int": int,
    "intstring": int,
    "real": float,
    "float": float,
    "number": float,
    "length_measure": float,
    "positive_length_measure": float,
    "plane_angle_measure": float,
    "positive_ratio_measure": float,
    "time_measure": float,
    "speed_measure": float,
    "rot_speed_measure": float,
    "pressure_measure": float,
    "parameter_value": float,
    "shape_tolerance": float,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    name: str
    type: str
    is_optional: bool


def _tables() -> dict[str, tuple[Row, ...]]:
    """Tables by keyword; AP238 moved attributes, so its chapter is not read."""
    text = TABLES.read_text(encoding="utf-8").partition("## Turning as in the AP238")[0]
    found = {}
    for section in re.split(r"^### ", text, flags=re.MULTILINE)[1:]:
        keyword = section.split(maxsplit=1)[0]
        rows = re.findall(r"^\| \d+ \| (.*) \|$", section, flags=re.MULTILINE)
        is_xsd = "required in XSD" in section
        found[keyword] = tuple(_row(row.split(" | "), is_xsd=is_xsd) for row in rows)
    return found


def _row(cells: list[str], *, is_xsd: bool) -> Row:
    name, kind, option = (cell.strip() for cell in cells[:3])
    is_list = kind.startswith("list[")
    is_optional = option != "required" and not is_list if is_xsd else option.startswith("yes")
    return Row(name=name, type=kind, is_optional=is_optional)


ALL = _tables() if TABLES.exists() else {}
NAMED = {key: rows for key, rows in ALL.items() if key not in ARITIES}
ABSTRACT = {"TOUCH_PROBING", "SHAPE_PROFILE", "PROFILE_FEATURE", "THREAD"} | {
    "APPROACH_LIFT_PATH",
    "AIR_STRATEGY",
}

pytestmark = pytest.mark.skipif(not ALL, reason=f"no {TABLES.name} beside the project")


def _every(cls: type[Entity]) -> list[type[Entity]]:
    return [cls] + [each for sub in cls.__subclasses__() for each in _every(sub)]


def _classes() -> dict[str, type[Entity]]:
    """Entities by keyword, the abstract ones too."""
    named = {each.express_name().upper(): each for each in _every(Entity)}
    return named | classes()


def test_every_table_has_an_entity() -> None:
    assert len(ALL) > 200
    assert not ALL.keys() - _classes().keys()


def test_abstract_entities_stand_in_no_file() -> None:
    assert not ABSTRACT & classes().keys()
    assert not (ALL.keys() - ABSTRACT) - classes().keys()


@pytest.mark.parametrize("keyword", NAMED)
def test_attributes_stand_in_the_order_of_the_standard(keyword: str) -> None:
    expected = tuple(
        RENAMED.get(f"{keyword}.{row.name}", RENAMED.get(row.name, row.name))
        for row in NAMED[keyword]
        if row.name not in LEFT_OUT
    )
    assert attributes(_classes()[keyword]) == expected + ADDED.get(keyword, ())


@pytest.mark.parametrize("keyword", NAMED)
def test_options_are_those_of_the_standard(keyword: str) -> None:
    slots = slots_of(_classes()[keyword])
    rows = [row for row in NAMED[keyword] if row.name not in LEFT_OUT]
    for slot, row in zip(slots.values(), rows, strict=False):
        expected = row.is_optional or f"{keyword}.{row.name}" in OPTIONAL_HERE
        assert slot.is_optional == expected, row.name


@pytest.mark.parametrize("keyword", NAMED)
def test_types_are_those_of_the_standard(keyword: str) -> None:
    known = {name.lower().replace("_", ""): each for name, each in _classes().items()}
    slots = slots_of(_classes()[keyword])
    rows = [row for row in NAMED[keyword] if row.name not in LEFT_OUT]
    for slot, row in zip(slots.values(), rows, strict=False):
        is_list = bool(re.match(r"(?:LIST|SET) ?\[|list\[", row.type))
        assert (slot.items is not None) == is_list, row.name
        one = slot.items or slot
        kind = re.sub(r".* OF |list\[|\]$", "", row.type).lower()
        if kind in PLAIN:
            assert PLAIN[kind] in one.plain, row.name
        elif kind.replace("_", "") in known:
            wanted = known[kind.replace("_", "")]
            assert any(issubclass(wanted, each) for each in one.references), row.name


@pytest.mark.parametrize("keyword", ARITIES)
def test_entities_without_names_have_their_number_of_attributes(keyword: str) -> None:
    assert len(attributes(classes()[keyword])) == ARITIES[keyword]


def test_knurling_tool_has_the_attributes_of_ap238() -> None:
    section = TABLES.read_text(encoding="utf-8").rpartition("### KNURLING_TOOL")[2]
    own = re.findall(r"^\| \d+ \| (\w+) \|.*\| knurling_tool \|$", section, flags=re.MULTILINE)
    assert attributes(classes()["KNURLING_TOOL"])[-len(own) :] == tuple(own)


def test_every_slot_takes_something() -> None:
    for cls in set(_classes().values()):
        for name, slot in slots_of(cls).items():
            assert slot != AttributeSlot(is_optional=slot.is_optional), f"{cls.__name__}.{name}"
