"""The library's own files: all load, keep their promises and agree with their sources."""

import csv
import os
from math import log10
from pathlib import Path

import pytest

from simulator.errors import LibraryError, UnknownMachine, UnknownMaterial
from simulator.files.grade_file import read_grades
from simulator.library import (
    DATA,
    find_grade,
    find_window,
    load_machine,
    load_material,
    machine_names,
    match_material,
    material_names,
)
from simulator.spec import CuttingMaterial, ToolConstruction, ToolKind
from stepnc_model.programs.plausibility import MAX_CUTTING_SPEED
from stepnc_model.units import m_min_from_speed
from tests.every_case import every_case

TABLE = Path(__file__).parents[3] / "shared" / "data" / "materials.csv"
HSS, CARBIDE, CERAMIC = CuttingMaterial.HSS, CuttingMaterial.CARBIDE, CuttingMaterial.CERAMIC


@pytest.mark.parametrize("name", machine_names())
def test_every_machine_of_the_library_loads(name: str) -> None:
    machine = load_machine(name)
    assert machine.name == name
    assert machine.source


def test_the_library_has_the_machines_that_the_documentation_names() -> None:
    assert set(machine_names()) >= {"paper002", "paper003", "vmc15", "lathe22"}


@every_case("name", material_names())
def test_every_material_of_the_library_loads(name: str) -> None:
    material = load_material(name)
    assert material.name == name
    assert material.source
    assert material.iso_group or name == "paper002"


def test_paper_002_carries_the_limits_of_its_table_2_and_no_others() -> None:
    machine, material = load_machine("paper002"), load_material("paper002")
    assert [point.power for point in machine.spindle.curve] == [290.0]
    assert machine.spindle.efficiency == 0.9
    limits = (
        machine.rapid,
        machine.max_feed,
        machine.max_cutting_force,
        machine.max_axial_depth,
        machine.block_time,
        machine.spindle.min_speed,
        machine.spindle.max_speed,
        machine.spindle.acceleration,
        material.min_feed_per_tooth_ratio,
        material.max_feed_per_tooth_ratio,
        material.windows[0].min_cutting_speed,
    )
    assert set(limits) == {None}
    assert machine.base_power == machine.tool_change == machine.coolant_power == 0.0
    assert (material.kienzle.k_c11, material.kienzle.m_c) == (1000.0, 0.0)
    assert material.max_feed_per_tooth == 0.5
    assert material.windows[0].max_cutting_speed == pytest.approx(35_000 / 60)
    assert material.iso_group == ""


def test_an_unknown_machine_is_told_with_the_nearest_name_first() -> None:
    with pytest.raises(UnknownMachine) as caught:
        load_machine("vmc16")
    assert caught.value.known[0] == "vmc15"
    assert set(caught.value.known) == set(machine_names())


def test_an_unknown_material_is_told_with_the_nearest_name_first() -> None:
    with pytest.raises(UnknownMaterial) as caught:
        load_material("c54")
    assert caught.value.near[0] == "c45"


def test_a_name_may_be_written_in_capitals() -> None:
    assert load_machine(" VMC15 ").name == "vmc15"
    assert load_material("C45").name == "c45"


@pytest.mark.parametrize("path", ["absent.toml", "./absent", "folder/absent.toml"])
def test_what_looks_like_a_path_is_one(path: str) -> None:
    with pytest.raises(LibraryError, match="cannot be read"):
        load_machine(path)
    with pytest.raises(LibraryError, match="cannot be read"):
        load_material(path)


def test_every_kind_of_tool_has_a_grade_in_hss_and_carbide_for_every_group() -> None:
    for kind in ToolKind:
        for group in "PMKNS":
            assert find_grade(kind, HSS, group).iso_group in {group, "*"}
            assert find_grade(kind, CARBIDE, group).iso_group in {group, "*"}
        assert find_grade(kind, CARBIDE, "H").cutting_material is CARBIDE
    assert find_grade(ToolKind.TURNING, CERAMIC, "K").cutting_material is CERAMIC


def test_a_grade_of_the_group_comes_before_the_one_for_all() -> None:
    assert find_grade(ToolKind.ENDMILL, CARBIDE, "N").iso_group == "N"
    assert find_grade(ToolKind.THREADING, CARBIDE, "N").iso_group == "*"


def test_a_grade_that_does_not_exist_is_an_error() -> None:
    with pytest.raises(LibraryError, match="no hss grade for ISO group 'H'"):
        find_grade(ToolKind.ENDMILL, HSS, "H")


def test_no_two_grades_answer_the_same_question() -> None:
    grades = [
        grade
        for kind in ToolKind
        for grade in read_grades(DATA / "tools" / f"{kind}.toml", kind)
    ]
    keys = [(g.tool_kind, g.cutting_material, g.iso_group) for g in grades]
    assert len(keys) == len(set(keys))


def test_an_end_mill_and_a_face_mill_of_carbide_have_different_speeds() -> None:
    material = load_material("c45")
    solid = find_window(material, ToolKind.ENDMILL, CARBIDE)
    inserts = find_window(material, ToolKind.FACEMILL, CARBIDE)
    assert solid is not None
    assert inserts is not None
    assert (solid.tool_body, inserts.tool_body) == (
        ToolConstruction.SOLID,
        ToolConstruction.INDEXABLE,
    )
    assert m_min_from_speed(solid.max_cutting_speed or 0) == pytest.approx(250)
    assert m_min_from_speed(inserts.max_cutting_speed or 0) == pytest.approx(280)


def test_the_other_window_serves_where_a_source_gives_only_one() -> None:
    window = find_window(load_material("inconel718"), ToolKind.TURNING, CARBIDE)
    assert window is not None
    assert window.tool_body is ToolConstruction.SOLID


def test_a_material_without_a_window_says_so() -> None:
    assert find_window(load_material("hardened_60hrc"), ToolKind.ENDMILL, HSS) is None


def test_no_speed_that_a_window_allows_is_implausible_in_a_file() -> None:
    """What is advised once is read again."""
    windows = [window for name in material_names() for window in load_material(name).windows]
    fastest = max(window.max_cutting_speed or 0.0 for window in windows)
    assert 10_000.0 < fastest <= MAX_CUTTING_SPEED


def rows() -> list[dict[str, str]]:
    if not TABLE.exists():
        pytest.skip(f"{os.path.relpath(TABLE)} is not here to compare with")
    with TABLE.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def number(text: str) -> float | None:
    return float(text) if text else None


def test_every_material_of_the_source_table_is_in_the_library_with_its_facts() -> None:
    for row in rows():
        material = match_material([row["name"]]).material
        assert material.title == row["name"]
        assert material.iso_group == row["iso"]
        if row["iso"] != "H":
            assert material.kienzle.k_c11 == float(row["kc11_N_mm2"])
        assert material.hardness_hb == number(row["hardness_HB"])
        assert material.tensile_strength == number(row["Rm_MPa"])
        assert material.density == float(row["density_g_cm3"])
        assert material.min_feed_per_tooth_ratio == number(row["fz_per_D_lo"])
        assert material.max_feed_per_tooth_ratio == number(row["fz_per_D_hi"])


def test_kienzles_law_gives_the_specific_force_of_the_source_table() -> None:
    for row in rows():
        if row["iso"] == "H":
            continue  # corrected by another source: measured forces lay far below the table's
        law = match_material([row["name"]]).material.kienzle
        at_a_tenth = float(row["kc_at_h0.1_N_mm2"])
        assert log10(law.k_c11 * 0.1**-law.m_c) == pytest.approx(log10(at_a_tenth), abs=2e-4)


@pytest.mark.parametrize("name", ["hardened_55hrc", "hardened_60hrc", "chilled_iron"])
def test_hardened_materials_are_below_the_one_table_that_measurements_passed(name: str) -> None:
    """At chips of turning its rows lay 51 and 164 % above what was measured."""
    law = load_material(name).kienzle
    for chip in (0.1, 0.2, 0.4):
        assert law.k_c11 * chip**-law.m_c < 4700.0 * 1.04 * chip**-0.2


def test_the_windows_are_those_of_the_source_table() -> None:
    columns = {
        (HSS, None): "Vc_HSS",
        (CARBIDE, ToolConstruction.SOLID): "Vc_solid_carbide",
        (CARBIDE, ToolConstruction.INDEXABLE): "Vc_indexable_carbide",
        (CERAMIC, None): "Vc_ceramic",
    }
    for row in rows():
        windows = match_material([row["name"]]).material.windows
        read = {
            (window.cutting_material, window.tool_body): (
                round(m_min_from_speed(window.min_cutting_speed or 0), 9),
                round(m_min_from_speed(window.max_cutting_speed or 0), 9),
            )
            for window in windows
        }
        printed = {
            key: (float(row[f"{column}_lo"]), float(row[f"{column}_hi"]))
            for key, column in columns.items()
            if row[f"{column}_lo"]
        }
        assert read == printed
