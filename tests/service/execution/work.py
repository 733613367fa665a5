"""Work that other processes do in tests."""

import os
import threading
import time
from pathlib import Path

from extras.factory.model.machining import MachiningPlan
from extras.factory.model.records import Listeners
from extras.factory.model.shop import Shop
from extras.factory.model.streams import Streams
from extras.factory.replications import run_shop

SHOP = """
hours = 4
[[machine]]
name = "mill"
count = 2
[machine.handling]
part_setup_s = { kind = "uniform", low = 10, high = 30 }
[[product]]
name = "part"
[[product.step]]
machines = ["mill"]
time_s = { kind = "exponential", mean = 60 }
"""


def replication(shop: Shop, number: int) -> tuple[float, ...]:
    """Figures of one replication: a few milliseconds of simulation."""
    run = run_shop(
        shop, MachiningPlan(), Streams(seed=3, replication=number), listeners=Listeners()
    )
    return tuple(each.value for each in run.measures)


def square(number: int) -> int:
    return number * number


def end_once(mark: Path, number: int) -> int:
    """End the process the first time that it is called anywhere."""
    try:
        mark.touch(exist_ok=False)
    except FileExistsError:
        return number
    os._exit(9)


def end_always(_: int) -> int:
    os._exit(9)


def refuse(number: int) -> int:
    raise ValueError(f"number {number}")


def take_time(seconds: float) -> float:
    """Wait: what a cluster has begun when it is killed."""
    time.sleep(seconds)
    return seconds


def go_on(mark: Path) -> None:
    """Work for ever, beside a file that is removed when this is broken off."""
    mark.touch()
    try:
        threading.Event().wait()
    finally:
        mark.unlink()
