"""Speed of the virtual factory, beside bare SimPy in the same run.

A shop of 50 machines runs for 4000 h at ten minutes a part. Each part has three states, each
batch two more; but a part passes in one SimPy event here, as nobody listens. Its peers are the
same line as a plain SimPy script, which takes an event a state, draws the same times and
records nothing, and processes that only wait, one for each machine: for as many events as there
are states, and for as many as SimPy has.
``python -m benchmarks.factory --hours 400``
"""

import argparse
import random
import resource
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import simpy

from service.factory.replications import run_shop
from simulator.factory.machining import MachiningPlan
from simulator.factory.measures import Level, Quantity
from simulator.factory.records import Listeners
from simulator.factory.shop import Shop
from simulator.factory.shop_file import read_shop
from simulator.factory.streams import Streams

MACHINES, HOURS = 50, 4_000.0

STATES, EVENTS = 3.2, 1.2
"""States and SimPy events of a part: three or one, and two for each batch of ten."""

SHOP = """
hours = {hours}
[[machine]]
name = "lathe"
count = {lathes}
idle_power_w = 1000
[machine.handling]
batch_setup_s = {{ kind = "uniform", low = 54, high = 66 }}
part_setup_s = {{ kind = "uniform", low = 27, high = 33 }}
part_ejection_s = {{ kind = "uniform", low = 18, high = 22 }}
batch_ejection_s = {{ kind = "uniform", low = 27, high = 33 }}
[[machine.failure]]
every_h = {{ kind = "exponential", mean = 100 }}
repair_min = {{ kind = "exponential", mean = 30 }}
[[machine]]
name = "mill"
count = {mills}
idle_power_w = 1000
[machine.handling]
batch_setup_s = {{ kind = "uniform", low = 54, high = 66 }}
part_setup_s = {{ kind = "uniform", low = 27, high = 33 }}
part_ejection_s = {{ kind = "uniform", low = 18, high = 22 }}
batch_ejection_s = {{ kind = "uniform", low = 27, high = 33 }}
[[buffer]]
name = "WIP"
capacity = 40
[[product]]
name = "part"
batch = 10
[[product.step]]
machines = ["lathe"]
time_s = {{ kind = "uniform", low = 520, high = 560 }}
power_w = 4000
into = "WIP"
[[product.step]]
machines = ["mill"]
time_s = {{ kind = "uniform", low = 520, high = 560 }}
power_w = 4000
"""


def shop_of(machines: int, hours: float) -> Shop:
    """Shop of half lathes and half mills."""
    text = SHOP.format(hours=hours, lathes=machines // 2, mills=machines - machines // 2)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "shop.toml"
        path.write_text(text, encoding="utf-8")
        return read_shop(path)


def shop_speed(machines: int, hours: float) -> tuple[float, int]:
    """Seconds and machined parts of a shop."""
    shop = shop_of(machines, hours)
    begin = time.perf_counter()
    run = run_shop(shop, MachiningPlan(), Streams(seed=1), listeners=Listeners())
    seconds = time.perf_counter() - begin
    parts = sum(
        each.value
        for each in run.measures
        if each.level is Level.MACHINE and each.quantity is Quantity.PARTS
    )
    return seconds, int(parts)


def script_speed(machines: int, hours: float) -> tuple[float, int]:
    """Seconds and machined parts of the same line as a plain script, without failures."""
    env = simpy.Environment()
    draw = random.Random(1)
    wip = simpy.Store(env, 40)
    made = [0]

    def batch() -> "simpy.events.ProcessGenerator":
        yield env.timeout(draw.uniform(54.0, 66.0))
        for _ in range(10):
            yield env.timeout(draw.uniform(27.0, 33.0))
            yield env.timeout(draw.uniform(520.0, 560.0))
            yield env.timeout(draw.uniform(18.0, 22.0))
            made[0] += 1
        yield env.timeout(draw.uniform(27.0, 33.0))

    def lathe() -> "simpy.events.ProcessGenerator":
        while True:
            yield from batch()
            yield wip.put(1)

    def mill() -> "simpy.events.ProcessGenerator":
        while True:
            yield wip.get()
            yield from batch()

    for row in range(machines):
        env.process(lathe() if row < machines // 2 else mill())
    begin = time.perf_counter()
    env.run(3600.0 * hours)
    return time.perf_counter() - begin, made[0]


def bare_speed(machines: int, events: int) -> float:
    """Seconds of processes that only wait, for a number of events."""
    env = simpy.Environment()

    def waits(count: int) -> "simpy.events.ProcessGenerator":
        for _ in range(count):
            yield env.timeout(1.0)

    for _ in range(machines):
        env.process(waits(events // machines))
    begin = time.perf_counter()
    env.run()
    return time.perf_counter() - begin


def event_ratio(hours: float = HOURS, rounds: int = 3) -> float:
    """Speed of the shop over that of bare SimPy by its events, each the best of some rounds."""
    seconds, parts = min(shop_speed(MACHINES, hours) for _ in range(rounds))
    bare = min(bare_speed(MACHINES, int(EVENTS * parts)) for _ in range(rounds))
    return bare / seconds


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--hours", type=float, default=HOURS)
    parser.add_argument("--machines", type=int, default=MACHINES)
    options = parser.parse_args(arguments)
    for hours in (options.hours / 10.0, options.hours):
        seconds, parts = shop_speed(options.machines, hours)
        script, made = script_speed(options.machines, hours)
        states = bare_speed(options.machines, int(STATES * parts))
        events = bare_speed(options.machines, int(EVENTS * parts))
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
        print(
            f"{options.machines} machines, {hours:g} h: {parts} parts machined in "
            f"{seconds:.1f} s, {STATES * parts / seconds:.0f} states/s; of a plain script "
            f"{script / made / (seconds / parts):.2f}, of bare SimPy {states / seconds:.2f} by "
            f"states, {events / seconds:.2f} by its events; peak memory {memory:.0f} MB"
        )


if __name__ == "__main__":
    main()
