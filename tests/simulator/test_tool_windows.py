"""Windows of a tool: the material's own group, else the nearest on the safe side."""

from dataclasses import replace

from simulator.library import load_material, material_names
from simulator.spec import CuttingMaterial, ToolKind
from simulator.tools.tool_table import GROUPS, grade_for, possible_groups, why_unsuited
from tests.every_case import every_case

HSS, CARBIDE, CERAMIC = CuttingMaterial.HSS, CuttingMaterial.CARBIDE, CuttingMaterial.CERAMIC
C45 = load_material("c45")


def test_windows_of_the_own_group_are_not_borrowed() -> None:
    grade = grade_for(ToolKind.ENDMILL, CARBIDE, C45)
    assert grade is not None
    assert (grade.iso_group, grade.borrowed) == ("P", "")


@every_case(
    ("kind", "edge", "group", "expected"),
    [
        (ToolKind.TURNING, CERAMIC, "M", "S"),
        (ToolKind.TURNING, CERAMIC, "N", "K"),
        (ToolKind.TURNING, CERAMIC, "H", "H"),
    ],
)
def test_a_group_without_a_grade_takes_the_nearest_that_is_harder_to_cut(
    kind: ToolKind, edge: CuttingMaterial, group: str, expected: str
) -> None:
    grade = grade_for(kind, edge, replace(C45, iso_group=group))
    assert grade is not None
    assert grade.iso_group == expected
    assert (grade.borrowed != "") == (group != expected)
    assert group == expected or f"group {group}" in grade.borrowed


def test_a_tool_without_windows_keeps_stiffness_and_strength() -> None:
    bare = grade_for(ToolKind.FACEMILL, CERAMIC, C45)
    assert bare is not None
    assert not bare.has_feeds
    assert bare.youngs_modulus > 0.0
    assert bare.bending_strength > 0.0
    assert grade_for(ToolKind.DRILL, CERAMIC, C45) is None


def test_the_data_of_a_material_without_a_group_exclude_groups() -> None:
    """Normalised C45: not as light as aluminium, too soft for group H."""
    groups = possible_groups(replace(C45, iso_group=""))
    assert "P" in groups
    assert not {"N", "H"} & set(groups)
    bare = replace(C45, iso_group="", hardness_hb=None, tensile_strength=None, density=None)
    assert set(groups) < set(possible_groups(bare))


def test_the_own_group_of_every_material_is_one_that_its_data_allow() -> None:
    for name in material_names():
        material = load_material(name)
        if material.iso_group:
            assert material.iso_group in possible_groups(replace(material, iso_group="")), name


def test_less_data_give_no_wider_windows() -> None:
    unknown = replace(C45, iso_group="")
    least = replace(unknown, hardness_hb=None, tensile_strength=None, density=None)
    for kind in (ToolKind.ENDMILL, ToolKind.DRILL, ToolKind.TURNING):
        own, some, none = (grade_for(kind, HSS, each) for each in (C45, unknown, least))
        feeds = [each.max_feed_ratio or each.max_feed for each in (own, some, none) if each]
        assert feeds == sorted(feeds, reverse=True)  # type: ignore[type-var]


@every_case("edge", [HSS, CARBIDE])
def test_feeds_and_depths_of_the_library_fall_in_the_order_of_the_groups(
    edge: CuttingMaterial,
) -> None:
    for kind in (ToolKind.ENDMILL, ToolKind.DRILL, ToolKind.FACEMILL, ToolKind.TURNING):
        grades = [grade_for(kind, edge, replace(C45, iso_group=group)) for group in GROUPS]
        known = [each for each in grades if each is not None and not each.borrowed]
        feeds = [
            each.max_feed_ratio or each.max_feed or 0.0 for each in known if each.has_feeds
        ]
        assert feeds == sorted(feeds, reverse=True)


@every_case("name", ["hardened_55hrc", "hardened_60hrc", "chilled_iron"])
def test_high_speed_steel_does_not_cut_group_h(name: str) -> None:
    material = load_material(name)
    assert "high-speed steel" in why_unsuited(HSS, material)
    assert not why_unsuited(CARBIDE, material)
    assert not why_unsuited(HSS, C45)


def test_a_hard_material_without_a_group_is_hard_all_the_same() -> None:
    hard = replace(load_material("hardened_55hrc"), iso_group="", hardness_hb=560.0)
    assert why_unsuited(HSS, hard)
