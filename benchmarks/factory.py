"""Speed of the virtual factory, beside bare SimPy in the same run.

A shop of 50 machines runs for 4000 h at ten minutes a part. Each part has three states, each
batch of ten two more. Its peers, all in CPU seconds of this process, are

- the same line as a plain SimPy script, which takes an event a state, draws the same times and
  records nothing;
- processes that only wait, one for each machine, with 3.2 waits a part: one for each state;
- the same with 1.2 waits a part: one for each part and two for its batch. That is what a part
  costs bare SimPy in a model without states, and the promised ratio is beside it.

The shop itself takes fewer events: as nobody listens, a whole batch passes in one, and more
come only where a machine waits or fails. 1.2 stays the measure: by the events that the shop
really takes, it would seem slower the fewer it needs.
``python -m benchmarks.factory --hours 400``
"""

import argparse
import random
import resource
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import simpy

from extras.factory.model.machining import MachiningPlan
from extras.factory.model.measures import Level, Quantity
from extras.factory.model.records import Listeners
from extras.factory.model.shop import Shop
from extras.factory.model.shop_file import read_shop
from extras.factory.model.streams import Streams
from extras.factory.replications import run_shop

MACHINES, HOURS = 50, 4_000.0

STATES, EVENTS = 3.2, 1.2
"""Waits of a part in bare SimPy: three or one, and two for each batch of ten."""

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
    """CPU seconds and machined parts of a shop."""
    shop = shop_of(machines, hours)
    begin = time.process_time()
    run = run_shop(shop, MachiningPlan(), Streams(seed=1), listeners=Listeners())
    seconds = time.process_time() - begin
    parts = sum(
        each.value
        for each in run.measures
        if each.level is Level.MACHINE and each.quantity is Quantity.PARTS
    )
    return seconds, int(parts)


def script_speed(machines: int, hours: float) -> tuple[float, int]:
    """CPU seconds and machined parts of the same line as a plain script, without failures."""
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
    begin = time.process_time()
    env.run(3600.0 * hours)
    return time.process_time() - begin, made[0]


def bare_speed(machines: int, events: int) -> float:
    """CPU seconds of processes that only wait, for a number of events."""
    env = simpy.Environment()

    def waits(count: int) -> "simpy.events.ProcessGenerator":
        for _ in range(count):
            yield env.timeout(1.0)

    for _ in range(machines):
        env.process(waits(events // machines))
    begin = time.process_time()
    env.run()
    return time.process_time() - begin


def event_ratio(hours: float = HOURS, rounds: int = 3) -> float:
    """Speed of the shop over that of bare SimPy at 1.2 waits a part.

    Each is the best of some rounds; they take turns, so that other work meets both.
    """
    shops, bare = [], []
    for _ in range(rounds):
        seconds, parts = shop_speed(MACHINES, hours)
        shops.append(seconds)
        bare.append(bare_speed(MACHINES, int(EVENTS * parts)))
    return min(bare) / min(shops)


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
            f"{seconds:.1f} s of CPU, {STATES * parts / seconds:.0f} states/s; "
            f"of a plain script {script / made / (seconds / parts):.2f}, "
            f"of bare SimPy {states / seconds:.2f} by states, {events / seconds:.2f} by parts; "
            f"peak memory {memory:.0f} MB"
        )


if __name__ == "__main__":
    main()
