"""Handling states and power deviation of a machine file, good and bad."""

from pathlib import Path

import pytest

from simulator.errors import LibraryError
from simulator.library import load_machine, machine_names
from simulator.spec import Handling, HandlingState, Machine, PowerDeviation
from tests.every_case import every_case

GOOD = """
title = "My mill"
kind = "mill"
source = "name plate"

[spindle]
efficiency = 0.8
source = "name plate"

[[spindle.curve]]
speed_rpm = 600
power_kw = 7.5

[handling]
batch_setup_s = 900
batch_setup_w = 1_300
part_setup_s = 60
part_setup_w = 1_200
part_ejection_s = 40
part_ejection_w = 1_250
batch_ejection_s = 300
batch_ejection_w = 1_400
time_scatter = 0.2
source = "stop watch"

[deviation]
feed = 0.1
traverse = 0.05
source = "power meter"
"""


def machine_of(text: str, folder: Path) -> Machine:
    path = folder / "my.toml"
    path.write_text(text, encoding="utf-8")
    return load_machine(str(path))


def test_states_and_deviation_are_read(tmp_path: Path) -> None:
    machine = machine_of(GOOD, tmp_path)
    assert machine.handling == Handling(
        batch_setup=HandlingState(time=900.0, power=1300.0),
        part_setup=HandlingState(time=60.0, power=1200.0),
        part_ejection=HandlingState(time=40.0, power=1250.0),
        batch_ejection=HandlingState(time=300.0, power=1400.0),
        time_scatter=0.2,
        source="stop watch",
    )
    assert machine.deviation == PowerDeviation(feed=0.1, traverse=0.05, source="power meter")


def test_a_file_without_them_has_none(tmp_path: Path) -> None:
    machine = machine_of(GOOD[: GOOD.index("[handling]")], tmp_path)
    assert machine.handling is None
    assert machine.deviation is None


def test_times_do_not_scatter_unless_the_file_says_so(tmp_path: Path) -> None:
    handling = machine_of(GOOD.replace("time_scatter = 0.2\n", ""), tmp_path).handling
    assert handling is not None
    assert handling.time_scatter == 0.0


@every_case(
    ("good", "bad", "key", "word"),
    [
        ("part_setup_s = 60", "part_setup_s = -1", "handling.part_setup_s", "below 0"),
        ("part_setup_w = 1_200", "", "handling.part_setup_w", "missing"),
        (
            "batch_setup_w = 1_300",
            "batch_setup_w = 2e6",
            "handling.batch_setup_w",
            "exceeds 1e+06",
        ),
        ("time_scatter = 0.2", "time_scatter = 20", "handling.time_scatter", "exceeds 1"),
        ("traverse = 0.05", "rapid = 0.05", "deviation.rapid", "unknown key"),
        ("feed = 0.1", "feed = 10", "deviation.feed", "exceeds 1"),
        ('source = "power meter"', "", "deviation.source", "missing"),
    ],
)
def test_a_bad_value_is_told_with_key_and_bound(
    good: str, bad: str, key: str, word: str, tmp_path: Path
) -> None:
    assert good in GOOD
    with pytest.raises(LibraryError) as caught:
        machine_of(GOOD.replace(good, bad), tmp_path)
    assert caught.value.key == key
    assert word in caught.value.message


@pytest.mark.parametrize("name", sorted(set(machine_names()) - {"paper002"}))
def test_each_machine_of_the_library_has_both_with_a_source(name: str) -> None:
    machine = load_machine(name)
    assert machine.handling is not None
    assert machine.deviation is not None
    assert machine.handling.source
    assert machine.deviation.source
    # Lowest state of all: the machine stands switched on.
    handling = machine.handling
    for state in (
        handling.batch_setup,
        handling.part_setup,
        handling.part_ejection,
        handling.batch_ejection,
    ):
        assert state.time > 0.0
        assert state.power >= machine.base_power


def test_the_paper_without_states_and_deviation_has_neither() -> None:
    machine = load_machine("paper002")
    assert machine.handling is None
    assert machine.deviation is None
