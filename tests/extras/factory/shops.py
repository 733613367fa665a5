"""Small shops for tests: a saw with times, and two mills with a program."""

from pathlib import Path

from extras.factory.model.shop import Shop
from extras.factory.model.shop_file import read_shop

PARTS = Path(__file__).parents[3] / "examples" / "parts"

TIMED = """
title = "Sawing, then milling"
hours = {hours}

[[machine]]
name = "saw 1"
idle_power_w = 200
[machine.handling]
part_setup_s = 10
part_setup_w = 300

[[machine]]
name = "mill"
count = 2
idle_power_w = 500
[machine.handling]
batch_setup_s = 60
batch_setup_w = 600

[[buffer]]
name = "WIP"
capacity = 1

[[product]]
name = "plate"
batch = 2
[[product.step]]
machines = ["saw 1"]
time_s = 50
power_w = 1000
into = "WIP"
[[product.step]]
machines = ["mill"]
time_s = 300
power_w = 2000
"""

PROGRAM = """
title = "Sawing, then a program"
hours = {hours}

[[machine]]
name = "saw"
idle_power_w = 200

[[machine]]
name = "mill"
machine = "vmc15"
count = 2
[machine.handling]
batch_setup_s = 30
batch_ejection_s = 10

[[buffer]]
name = "WIP"
capacity = 2

[[product]]
name = "test part"
batch = 2
[[product.step]]
machines = ["saw"]
time_s = 60
power_w = 1000
into = "WIP"
[[product.step]]
machines = ["mill"]
program = "paper003_case1.stpnc"
"""


def timed_file(folder: Path, *, hours: float = 2.0) -> Path:
    """File of a shop with times only."""
    file = folder / "timed.toml"
    file.write_text(TIMED.format(hours=hours), encoding="utf-8")
    return file


def program_file(folder: Path, *, hours: float = 2.0) -> Path:
    """File of a shop with a program, and the program beside it."""
    file = folder / "program.toml"
    file.write_text(PROGRAM.format(hours=hours), encoding="utf-8")
    name = "paper003_case1.stpnc"
    (folder / name).write_bytes((PARTS / name).read_bytes())
    return file


def timed_shop(folder: Path, *, hours: float = 2.0) -> Shop:
    """Shop with times only."""
    return read_shop(timed_file(folder, hours=hours))
