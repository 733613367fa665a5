"""The XML form of paper 003."""

from dataclasses import replace
from pathlib import Path

import pytest

from simulator.errors import LibraryError
from simulator.files.machine_xml import read_machine_xml
from simulator.library import load_machine
from simulator.spec import Handling, HandlingState, PowerDeviation
from tests.every_case import every_case

EXAMPLE = Path(__file__).parents[2] / "simulator" / "data" / "paper003.xml"


def with_change(folder: Path, old: str, new: str) -> Path:
    text = EXAMPLE.read_text(encoding="utf-8")
    assert old in text
    path = folder / "my.xml"
    path.write_text(text.replace(old, new), encoding="utf-8")
    return path


def test_the_audited_reading_of_figure_5() -> None:
    machine = read_machine_xml(EXAMPLE)
    assert machine.rapid == pytest.approx(16_000 / 60)  # PHYSICS §1.3 t: 16 m/min
    assert machine.spindle.acceleration == 10.0  # rev/s²
    assert machine.spindle.inertia == 0.5
    assert machine.spindle.efficiency == 0.95
    assert [axis.acceleration for axis in machine.axes] == [6000.0] * 3
    assert (machine.base_power, machine.coolant_power) == (370.0, 280.0)
    assert machine.spindle.curve[0].power == 1_000_000  # not given; no cut reaches it


def test_the_xml_and_the_library_say_the_same_of_paper_003() -> None:
    xml, toml = load_machine(str(EXAMPLE)), load_machine("paper003")
    one, other = (
        replace(
            each,
            title="",
            source="",
            remarks=(),
            only_stated_limits=False,
            handling=each.handling and replace(each.handling, source=""),
            deviation=each.deviation and replace(each.deviation, source=""),
        )
        for each in (xml, toml)
    )
    assert one.handling is not None
    assert one.deviation is not None
    assert one == other


def test_states_and_deviation_of_figure_5() -> None:
    machine = read_machine_xml(EXAMPLE)
    assert machine.handling == Handling(
        batch_setup=HandlingState(time=60.0, power=4400.0),
        part_setup=HandlingState(time=30.0, power=1206.0),
        part_ejection=HandlingState(time=20.0, power=976.0),
        batch_ejection=HandlingState(time=30.0, power=3400.0),
        time_scatter=0.1,
        source="paper003.xml, read as powers in W and times in ms",
    )
    assert machine.deviation == PowerDeviation(
        feed=0.1, traverse=0.05, source="paper003.xml, randomProperty"
    )
    remarks = " ".join(machine.remarks)
    assert "section 4.2 says uniform" in remarks
    assert "no scatter of setup and ejection times" in remarks


def test_without_random_property_nothing_deviates(tmp_path: Path) -> None:
    path = with_change(tmp_path, 'randomProperty="0.05;0.1" randomType="Uniform"', "")
    machine = read_machine_xml(path)
    assert machine.deviation is None
    assert machine.handling is not None
    assert machine.handling.time_scatter == 0.0
    assert "randomProperty" not in " ".join(machine.remarks)


def test_states_that_are_half_given_are_none_and_say_so(tmp_path: Path) -> None:
    machine = read_machine_xml(with_change(tmp_path, 'partSetupTime="30000"', ""))
    assert machine.handling is None
    assert any("Without partSetupTime" in remark for remark in machine.remarks)


def test_every_assumed_unit_is_a_remark() -> None:
    remarks = " ".join(read_machine_xml(EXAMPLE).remarks)
    for name in (
        "basicRapidSpeed",
        "angularAcceleration",
        "pitchFeedScrew",
        "feedScrewDiameter",
        "frictionCoefficient",
        "Energy",
    ):
        assert name in remarks
    assert "'TurningMc1', but the form describes a mill" in remarks


def test_the_drive_is_read_in_canonical_units() -> None:
    drives = [axis.drive for axis in read_machine_xml(EXAMPLE).axes]
    assert drives[0] is not None
    assert drives == [drives[0]] * 3
    assert (drives[0].lead, drives[0].screw_diameter) == (15.0, 30.0)  # mm
    assert drives[0].viscous == 5.0  # N·mm·s/rad


def test_a_drive_that_is_half_given_is_none_and_says_so(tmp_path: Path) -> None:
    machine = read_machine_xml(with_change(tmp_path, 'preloadForce="1800"', ""))
    assert [axis.drive for axis in machine.axes] == [None] * 3
    assert any("Without preloadForce" in remark for remark in machine.remarks)


def test_the_corrected_spelling_is_read_too(tmp_path: Path) -> None:
    path = with_change(tmp_path, "partEstupEnergy", "partSetupEnergy")
    assert read_machine_xml(path).base_power == 370.0


def test_an_id_that_looks_like_a_number_is_a_name(tmp_path: Path) -> None:
    assert read_machine_xml(with_change(tmp_path, "TurningMc1", "7")).title == "7"


@every_case(
    ("old", "new", "key", "word"),
    [
        ('pDefaultLoad="370"', 'pDefaultLoad="-1"', "Machine.pDefaultLoad", "below 0"),
        (
            'pDefaultLoad="370"',
            'pDefaultLoad="much"',
            "Machine.pDefaultLoad",
            "not a number",
        ),
        ('pDefaultLoad="370"', "", "Machine.pDefaultLoad", "missing"),
        ('pDefaultLoad="370"', 'pDefaultLod="370"', "Machine.pDefaultLod", "unknown key"),
        ('gravity="9.81"', 'gravitation="9.81"', "Machine.gravitation", "unknown key"),
        ('gravity="9.81"', 'gravity="981"', "Machine.gravity", "exceeds 9.9"),
        (
            'basicRapidSpeed="1600"',
            'basicRapidSpeed="1.6"',
            "Machine.basicRapidSpeed",
            "below 10",
        ),
        (
            'pitchFeedScrew="0.015"',
            'pitchFeedScrew="15"',
            "Machine.pitchFeedScrew",
            "exceeds 0.5",
        ),
        (
            'randomType="Uniform"',
            'randomType="Normal"',
            "Machine.randomType",
            "not one of",
        ),
        (
            'randomType="Uniform"',
            "",
            "Machine.randomType",
            "missing",
        ),
        (
            'randomProperty="0.05;0.1"',
            "",
            "Machine.randomProperty",
            "missing",
        ),
        (
            'randomProperty="0.05;0.1"',
            'randomProperty="0.05"',
            "Machine.randomProperty",
            "two half-widths",
        ),
        (
            'randomProperty="0.05;0.1"',
            'randomProperty="0.05;10"',
            "Machine.randomProperty",
            "two half-widths",
        ),
        ("<Machines>", "<Machines", "", "not XML"),
        ("<Machine\n", "<Robot\n", "Machine", "no Machine"),
    ],
)
def test_a_bad_attribute_is_told(
    old: str, new: str, key: str, word: str, tmp_path: Path
) -> None:
    with pytest.raises(LibraryError) as caught:
        read_machine_xml(with_change(tmp_path, old, new))
    assert caught.value.key == key
    assert word in caught.value.message


def test_an_absent_file_is_told(tmp_path: Path) -> None:
    with pytest.raises(LibraryError, match="cannot be read: No such file"):
        load_machine(str(tmp_path / "absent.xml"))


def test_an_entity_is_not_followed_into_another_file(tmp_path: Path) -> None:
    secret = tmp_path / "secret.txt"
    secret.write_text("370", encoding="utf-8")
    path = tmp_path / "my.xml"
    path.write_text(
        f'<!DOCTYPE Machine [<!ENTITY load SYSTEM "{secret.as_uri()}">]>\n'
        '<Machine id="&load;"/>',
        encoding="utf-8",
    )
    with pytest.raises(LibraryError) as caught:
        read_machine_xml(path)
    assert "370" not in str(caught.value)
