"""A work material from its TOML file, good and bad."""

from math import radians
from pathlib import Path

import pytest

from simulator.errors import LibraryError
from simulator.library import load_material
from simulator.spec import CuttingMaterial, ToolConstruction, WorkMaterial
from tests.every_case import every_case

GOOD = """
title = "My steel"
iso_group = "P"
hardness_hb = 200
source = "certificate"
confidence = "measured on my machine"

[kienzle]
k_c11_n_mm2 = 1700
m_c = 0.25
rake_angle_deg = 6
source = "turning tests"

[linear_edge]
k_tc_n_mm2 = 2000
k_te_n_mm = 20
source = "milling tests"

[[window]]
cutting_material = "carbide"
tool_body = "indexable"
min_cutting_speed_m_min = 120
max_cutting_speed_m_min = 240
source = "catalogue"

[[tool_life]]
cutting_material = "carbide"
exponent = 0.25
constant_m_min = 300
source = "tests"

[feed_per_tooth]
min_ratio = 0.005
max_ratio = 0.01
source = "catalogue"
"""


def material_of(text: str, folder: Path) -> WorkMaterial:
    path = folder / "my.toml"
    path.write_text(text, encoding="utf-8")
    return load_material(str(path))


def test_a_users_own_file_is_read_in_canonical_units(tmp_path: Path) -> None:
    material = material_of(GOOD, tmp_path)
    assert (material.name, material.iso_group, material.source) == ("my", "P", "turning tests")
    assert material.kienzle.rake_angle == pytest.approx(radians(6))
    assert material.linear_edge is not None
    assert (material.linear_edge.k_te, material.linear_edge.k_rc) == (20, 0)
    window = material.windows[0]
    assert (window.cutting_material, window.tool_body) == (
        CuttingMaterial.CARBIDE,
        ToolConstruction.INDEXABLE,
    )
    assert (window.min_cutting_speed, window.max_cutting_speed) == (2000.0, 4000.0)
    assert window.taylor is not None
    assert window.taylor.constant == 5000.0
    assert material.remarks[0] == "measured on my machine"
    assert material.remarks[1].startswith("turning: feed force 0.45 (0.27 to 0.80)")


@every_case(
    ("good", "bad", "key", "word"),
    [
        ("m_c = 0.25", "m_c = 1.1", "kienzle.m_c", "exceeds 0.9"),
        ("m_c = 0.25", "m_c = -0.1", "kienzle.m_c", "below 0"),
        ("m_c = 0.25", "", "kienzle.m_c", "missing"),
        ("k_c11_n_mm2 = 1700", "k_c11_n_mm2 = 1.7", "kienzle.k_c11_n_mm2", "below 50"),
        ("k_c11_n_mm2 = 1700", "k_c11_n_mm2 = inf", "kienzle.k_c11_n_mm2", "finite"),
        ('iso_group = "P"', 'iso_group = "Q"', "iso_group", "not one of"),
        ('iso_group = "P"', "", "iso_group", "missing"),
        ("hardness_hb = 200", "hardness_hrc = 20", "hardness_hrc", "unknown key"),
        (
            "min_ratio = 0.005",
            "min_ratio = 0.05",
            "feed_per_tooth.min_ratio",
            "exceeds max_ratio",
        ),
        (
            "min_cutting_speed_m_min = 120",
            "min_cutting_speed_m_min = 300",
            "window[1].min_cutting_speed_m_min",
            "exceeds max_cutting_speed_m_min",
        ),
        ('"carbide"\nexponent', '"hss"\nexponent', "tool_life", "no [[window]]"),
        (
            'tool_body = "indexable"',
            'tool_body = "glued"',
            "window[1].tool_body",
            "not one of",
        ),
        ('source = "turning tests"', "", "kienzle.source", "missing"),
        ("[kienzle]", "[kienzel]", "kienzel", "unknown key"),
    ],
)
def test_a_bad_value_is_told_with_key_value_and_bound(
    good: str, bad: str, key: str, word: str, tmp_path: Path
) -> None:
    assert good in GOOD
    with pytest.raises(LibraryError) as caught:
        material_of(GOOD.replace(good, bad, 1), tmp_path)
    assert caught.value.key == key
    assert word in caught.value.message


def test_alternatives_are_checked_but_not_loaded(tmp_path: Path) -> None:
    alternative = '[[kienzle_alternative]]\nk_c11_n_mm2 = 1500\nm_c = 0.3\nsource = "other"\n'
    assert material_of(GOOD + alternative, tmp_path).kienzle.k_c11 == 1700
    with pytest.raises(LibraryError, match=r"kienzle_alternative\[1\].m_c: 3 exceeds 0.9"):
        material_of(GOOD + alternative.replace("0.3", "3"), tmp_path)


def test_a_measured_share_of_turning_is_read_with_its_range(tmp_path: Path) -> None:
    share = """
[turning_share]
feed_share = 0.4
min_feed_share = 0.3
max_feed_share = 0.5
back_share = 0.6
min_back_share = 0.5
max_back_share = 0.9
source = "dynamometer"
"""
    material = material_of(GOOD + share, tmp_path)
    assert material.feed_force is not None
    assert material.feed_force.k_c11 == pytest.approx(0.4 * material.kienzle.k_c11)
    assert material.feed_force.m_c == material.kienzle.m_c
    assert material.remarks[-1] == (
        "turning: feed force 0.4 (0.3 to 0.5), back force 0.6 (0.5 to 0.9) of the cutting"
        " force: dynamometer"
    )
    beyond = share.replace("back_share = 0.6", "back_share = 0.95")
    with pytest.raises(LibraryError, match=r"0\.95 is not within 0\.5 to 0\.9"):
        material_of(GOOD + beyond, tmp_path)
