"""Shop files: what they may say, and how they are refused."""

import json
import tomllib
from pathlib import Path

import pytest

from extras.factory.model.shop import Counting
from extras.factory.model.shop_file import read_shop
from extras.factory.model.states import MachineState
from simulator.errors import LibraryError
from tests.every_case import every_case
from tests.extras.factory.model.shops import shop_of

GOOD = """
title = "Two machines"
hours = 10
[[shift]]
name = "day"
hours = ["Mon-Fri 06:00-14:00"]
[[machine]]
name = "a"
machine = "vmc15"
count = 2
shift = "day"
[[machine.failure]]
every_h = { kind = "exponential", mean = 5 }
repair_min = 30
[[machine]]
name = "b"
[[buffer]]
name = "wip"
capacity = 2
[[crew]]
name = "setters"
tasks = ["batch set-up"]
machines = ["a"]
[[product]]
name = "p"
batch = 10
arrival_min = { kind = "uniform", low = 10, high = 20 }
[[product.step]]
machines = ["a"]
time_s = 60
into = "wip"
[[product.step]]
machines = ["b"]
time_s = { kind = "triangular", low = 1, mode = 2, high = 9 }
scrap = 0.01
"""

REFUSED = {
    "unknown machine": ('machines = ["b"]', 'machines = ["c"]',
                        "product[1].step[2].machines", "unknown"),
    "unknown library": ('"vmc15"', '"vmc16"', "machine[1].machine", "unknown machine"),
    "unknown buffer": ('into = "wip"', 'into = "w"',
                       "product[1].step[1].into", "unknown"),
    "unknown shift": ('shift = "day"', 'shift = "night"',
                      "machine[1].shift", "unknown"),
    "negative time": ("low = 10, high", "low = -10, high",
                      "product[1].arrival_min.low", "below 0"),
    "reversed time": ("low = 10, high = 20", "low = 30, high = 20",
                      "product[1].arrival_min.low", "exceeds high"),
    "mode above": ("mode = 2, high = 9", "mode = 12, high = 9",
                   "product[1].step[2].time_s.mode", "exceeds high"),
    "key of another kind": ('"exponential", mean = 5', '"exponential", mean = 5, low = 1',
                            "machine[1].failure[1].every_h.low", "only mean"),
    "missing mean": ('"exponential", mean = 5', '"exponential"',
                     "machine[1].failure[1].every_h.mean", "missing"),
    "unknown kind": ('"exponential"', '"poisson"',
                     "machine[1].failure[1].every_h.kind", "not one of"),
    "share": ("scrap = 0.01", "scrap = 1.5", "product[1].step[2].scrap", "exceeds 1"),
    "no parts": ("batch = 10", "batch = 0", "product[1].batch", "below 1"),
    "half parts": ("batch = 10", "batch = 2.5", "product[1].batch", "whole number"),
    "negative room": ("capacity = 2", "capacity = -1", "buffer[1].capacity", "below 0"),
    "task": ('"batch set-up"]', '"starved"]', "crew[1].tasks", "no crew"),
    "hours": ("06:00-14:00", "6-14", "shift[1].hours", "days and hours"),
    "day": ("Mon-Fri", "Mon-Fry", "shift[1].hours", "unknown day"),
    "clock": ("14:00", "26:00", "shift[1].hours", "time of a day"),
    "twice": ('name = "b"', 'name = "a-1"', "machine", "2 times"),
    "typo": ("capacity", "capcity", "buffer[1].capcity", "unknown key"),
    "neither": ("time_s = 60\n", "", "product[1].step[1].program", "either a program"),
    "both": ("time_s = 60\n", 'time_s = 60\nprogram = "x"\n',
             "product[1].step[1].program", "either a program"),
    "never works": ("mean = 5", "mean = 0", "machine[1].failure[1].every_h", "never work"),
    "warm-up": ("hours = 10\n", "hours = 10\nwarm_up_hours = 10\n",
                "warm_up_hours", "not below"),
    "start": ("hours = 10\n", 'hours = 10\nstart = "noon"\n', "start", "expected a day"),
    "behind the last": ("scrap = 0.01", 'into = "wip"',
                        "product[1].step[2].into", "last step"),
    "no machines": ('machines = ["b"]', "machines = []",
                    "product[1].step[2].machines", "empty"),
    "text for a number": ("batch = 10", 'batch = "ten"', "product[1].batch", "not a number"),
}  # fmt: skip


def test_a_good_file(tmp_path: Path) -> None:
    shop = shop_of(GOOD, tmp_path)
    assert [each.name for each in shop.machines] == ["a-1", "a-2", "b"]
    assert shop.machines[0].idle_power == 1200.0
    assert shop.machines[0].handling[MachineState.BATCH_SETUP].power == 1300.0
    assert shop.machines[0].failures[0].counts is Counting.MACHINING
    assert shop.machines[0].failures[0].between.mean == 5 * 3600.0
    assert shop.machines[0].failures[0].repair.mean == 1800.0
    assert shop.products[0].steps[0].machines == ("a-1", "a-2")
    assert shop.products[0].arrival is not None
    assert shop.products[0].arrival.average == 900.0
    assert shop.crews[0].machines == {"a-1", "a-2"}
    assert shop.duration == 36_000.0


def test_json_says_the_same(tmp_path: Path) -> None:
    path = tmp_path / "shop.json"
    path.write_text(json.dumps(tomllib.loads(GOOD)), encoding="utf-8")
    assert read_shop(path) == shop_of(GOOD, tmp_path)


@every_case("case", REFUSED)
def test_bad_files_are_refused(tmp_path: Path, case: str) -> None:
    before, after, key, word = REFUSED[case]
    assert before in GOOD
    with pytest.raises(LibraryError) as caught:
        shop_of(GOOD.replace(before, after), tmp_path)
    assert caught.value.path == str(tmp_path / "shop.toml")
    assert caught.value.key == key
    assert word in caught.value.message


def test_a_refusal_names_the_file_the_key_and_what_is_known(tmp_path: Path) -> None:
    with pytest.raises(LibraryError) as caught:
        shop_of(GOOD.replace('machines = ["b"]', 'machines = ["c"]'), tmp_path)
    assert str(caught.value) == (
        f"{tmp_path / 'shop.toml'}: product[1].step[2].machines: "
        "unknown 'c'; known: a-1, a-2, b, a"
    )


@pytest.mark.parametrize("text", ["{", "[]", "nonsense", ""])
def test_bad_json_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "shop.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(LibraryError, match=r"shop\.json"):
        read_shop(path)


def test_a_loop_without_room_is_refused(tmp_path: Path) -> None:
    text = GOOD.replace("capacity = 2", "capacity = 0").replace(
        "scrap = 0.01", 'into = "wip"\n[[product.step]]\nmachines = ["a"]\ntime_s = 5'
    )
    with pytest.raises(LibraryError, match=r"buffer: capacity 0 of 'wip' on the loop a-1 -> b"):
        shop_of(text, tmp_path)
    shop_of(text.replace("capacity = 0", "capacity = 1"), tmp_path)


def test_raw_stock_without_end_needs_time(tmp_path: Path) -> None:
    text = GOOD.replace(
        'arrival_min = { kind = "uniform", low = 10, high = 20 }\n', ""
    ).replace("time_s = 60", "time_s = 0")
    shop_of(text, tmp_path)  # vmc15 has set-ups
    bare = text.replace('machine = "vmc15"\n', "")
    with pytest.raises(LibraryError, match=r"product\[1\].step\[1\].time_s: 0 s on a-1"):
        shop_of(bare, tmp_path)
    shop_of(bare.replace("batch = 10", "batch = 10\nbatches = 3"), tmp_path)


def test_changes_replace_values(tmp_path: Path) -> None:
    path = tmp_path / "shop.toml"
    path.write_text(GOOD, encoding="utf-8")
    shop = read_shop(path, changes={"product[1].batch": 3.0, "machine[1].count": 1.0})
    assert shop.products[0].batch == 3
    assert [each.name for each in shop.machines] == ["a", "b"]
    for key in ("product[2].batch", "product[1].step[9].time_s", "nothing[1].x", "title.x"):
        with pytest.raises(LibraryError, match="is not in the file; rows count from 1"):
            read_shop(path, changes={key: 1.0})
    with pytest.raises(LibraryError, match=r"product\[1\].batch: 0 parts is below"):
        read_shop(path, changes={"product[1].batch": 0.0})
