"""Tables that say how a workpiece is held."""

from pathlib import Path

import pytest

from simulator.errors import LibraryError
from simulator.files.holding_file import read_holding_file
from simulator.spec import MachineKind
from simulator.work_holding import Chuck, Clamp, Holding
from tests.every_case import every_case

CHUCK = """
[[holding]]
kind = "chuck"
setup = "OP 10"
clamping_force_kn = 45
friction = 0.2
jaws = 3
grip_diameter_mm = 60
grip_length_mm = 30
jaw_face_z_mm = -120
jaw_mass_kg = 1.2
jaw_radius_mm = 72
lost_force_kn = 3
lost_at_rpm = 3000
safety_factor = 2.5
clamping_safety_factor = 1.6
tailstock = true
source = "data sheet"
"""
VICE = """
[[holding]]
kind = "vice"
holding_force_kn = 25
friction = 0.15
source = "torque wrench"
"""


def held(
    text: str, tmp_path: Path, kind: MachineKind = MachineKind.LATHE
) -> tuple[Holding, ...]:
    file = tmp_path / "holding.toml"
    file.write_text(text, encoding="utf-8")
    return read_holding_file(file, kind)


def test_a_chuck_is_read_in_canonical_units(tmp_path: Path) -> None:
    assert held(CHUCK, tmp_path) == (
        Chuck(
            clamping_force=45_000.0,
            friction=0.2,
            source="data sheet",
            setup="OP 10",
            jaws=3,
            grip_diameter=60.0,
            grip_length=30.0,
            jaw_face=-120.0,
            jaw_mass=1.2,
            jaw_radius=72.0,
            lost_force=3_000.0,
            lost_at=50.0,
            safety_factor=2.5,
            clamping_safety_factor=1.6,
            has_tailstock=True,
        ),
    )


def test_little_is_needed(tmp_path: Path) -> None:
    text = '[[holding]]\nkind = "chuck"\nclamping_force_kn = 45\nfriction = 0.2\nsource = ""\n'
    assert held(text, tmp_path) == (Chuck(clamping_force=45_000.0, friction=0.2, source=""),)


@pytest.mark.parametrize("kind", ["vice", "clamps"])
def test_a_vice_and_clamps_hold_alike(kind: str, tmp_path: Path) -> None:
    text = VICE.replace('"vice"', f'"{kind}"')
    assert held(text, tmp_path, MachineKind.MILL) == (
        Clamp(holding_force=25_000.0, friction=0.15, source="torque wrench"),
    )


@every_case(
    ("good", "bad", "key", "word"),
    [
        (
            "clamping_force_kn = 45",
            "clamping_force_kn = 0",
            "holding[1].clamping_force_kn",
            "below 0.01",
        ),
        ("clamping_force_kn = 45\n", "", "holding[1].clamping_force_kn", "missing"),
        ("friction = 0.2", "friction = 1.5", "holding[1].friction", "exceeds 1"),
        ("friction = 0.2\n", "", "holding[1].friction", "missing"),
        ("jaws = 3", "jaws = 2.5", "holding[1].jaws", "whole number"),
        ("jaws = 3", "jaws = 1", "holding[1].jaws", "below 2"),
        ("jaw_radius_mm = 72\n", "", "holding[1].jaw_radius_mm", "missing"),
        ("lost_at_rpm = 3000\n", "", "holding[1].lost_at_rpm", "missing"),
        ("safety_factor = 2.5", "safety_factor = 0.9", "holding[1].safety_factor", "below 1"),
        (
            "tailstock = true",
            'tailstock = "yes"',
            "holding[1].tailstock",
            "neither true nor false",
        ),
        ('kind = "chuck"', 'kind = "glue"', "holding[1].kind", "not one of"),
        ('source = "data sheet"\n', "", "holding[1].source", "missing"),
        ("grip_length_mm", "grip_lenght_mm", "holding[1].grip_lenght_mm", "unknown key"),
    ],
)
def test_bad_tables_are_told(good: str, bad: str, key: str, word: str, tmp_path: Path) -> None:
    assert good in CHUCK
    with pytest.raises(LibraryError) as error:
        held(CHUCK.replace(good, bad), tmp_path)
    assert error.value.key == key
    assert word in error.value.message


def test_a_vice_holds_on_no_lathe_and_a_chuck_on_no_mill(tmp_path: Path) -> None:
    with pytest.raises(LibraryError, match=r"holding\[1\].kind: a vice on a lathe"):
        held(VICE, tmp_path)
    with pytest.raises(LibraryError, match=r"holding\[1\].kind: a chuck on a mill"):
        held(CHUCK, tmp_path, MachineKind.MILL)


def test_a_setup_is_held_once(tmp_path: Path) -> None:
    with pytest.raises(LibraryError, match="'op 10' is held twice"):
        held(CHUCK + CHUCK, tmp_path)
    with pytest.raises(LibraryError, match="missing twice"):
        held(VICE + VICE, tmp_path, MachineKind.MILL)


def test_a_file_without_a_table_is_refused(tmp_path: Path) -> None:
    with pytest.raises(LibraryError, match=r"has no \[\[holding\]\]"):
        held("", tmp_path)
