"""Every entity has the attributes of the standard, in their order and with their options.

The tables are read in place; where an entity differs on purpose, the difference is listed.
"""

import re
from dataclasses import dataclass
from functools import cache
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


@cache
def _classes() -> dict[str, type[Entity]]:
    """Entities by keyword, the abstract ones too."""
    named = {each.express_name().upper(): each for each in _every(Entity)}
    return named | classes()


@cache
def _by_plain_name() -> dict[str, type[Entity]]:
    """Entities by keyword in lower case without underscores, as the XSD writes them."""
    return {name.lower().replace("_", ""): each for name, each in _classes().items()}


def test_every_table_has_an_entity() -> None:
    assert len(ALL) > 200
    assert not ALL.keys() - _classes().keys()


def test_abstract_entities_stand_in_no_file() -> None:
    assert not ABSTRACT & classes().keys()
    assert not (ALL.keys() - ABSTRACT) - classes().keys()


def _slots(keyword: str) -> list[tuple[Row, AttributeSlot]]:
    """Attributes of the standard beside those of the entity."""
    rows = [row for row in NAMED[keyword] if row.name not in LEFT_OUT]
    return list(zip(rows, slots_of(_classes()[keyword]).values(), strict=False))


def _expected(keyword: str) -> tuple[str, ...]:
    """Names of an entity's attributes as the standard gives them."""
    names = (row.name for row in NAMED[keyword] if row.name not in LEFT_OUT)
    found = (RENAMED.get(f"{keyword}.{name}", RENAMED.get(name, name)) for name in names)
    return (*found, *ADDED.get(keyword, ()))


def test_attributes_stand_in_the_order_of_the_standard() -> None:
    found = {keyword: attributes(_classes()[keyword]) for keyword in NAMED}
    assert {key: names for key, names in found.items() if names != _expected(key)} == {}


def test_options_are_those_of_the_standard() -> None:
    wrong = [
        f"{keyword}.{row.name}"
        for keyword in NAMED
        for row, slot in _slots(keyword)
        if slot.is_optional != (row.is_optional or f"{keyword}.{row.name}" in OPTIONAL_HERE)
    ]
    assert wrong == []


def test_types_are_those_of_the_standard() -> None:
    wrong = [
        f"{keyword}.{row.name}: {row.type}"
        for keyword in NAMED
        for row, slot in _slots(keyword)
        if not _is_of_type(slot, row.type)
    ]
    assert wrong == []


def _is_of_type(slot: AttributeSlot, wanted: str) -> bool:
    """Whether an attribute takes what the table gives; unknown types are not compared."""
    is_list = bool(re.match(r"(?:LIST|SET) ?\[|list\[", wanted))
    if (slot.items is not None) != is_list:
        return False
    one = slot.items or slot
    kind = re.sub(r".* OF |list\[|\]$", "", wanted).lower()
    if kind in PLAIN:
        return PLAIN[kind] in one.plain
    entity = _by_plain_name().get(kind.replace("_", ""))
    return entity is None or any(issubclass(entity, each) for each in one.references)


def test_entities_without_names_have_their_number_of_attributes() -> None:
    found = {keyword: len(attributes(classes()[keyword])) for keyword in ARITIES}
    assert {key: count for key, count in found.items() if count != ARITIES[key]} == {}


def test_knurling_tool_has_the_attributes_of_ap238() -> None:
    section = TABLES.read_text(encoding="utf-8").rpartition("### KNURLING_TOOL")[2]
    own = re.findall(r"^\| \d+ \| (\w+) \|.*\| knurling_tool \|$", section, flags=re.MULTILINE)
    assert attributes(classes()["KNURLING_TOOL"])[-len(own) :] == tuple(own)


def test_every_slot_takes_something() -> None:
    empty = [
        f"{cls.__name__}.{name}"
        for cls in set(_classes().values())
        for name, slot in slots_of(cls).items()
        if slot == AttributeSlot(is_optional=slot.is_optional)
    ]
    assert empty == []
