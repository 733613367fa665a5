"""Posting and reading: blocks a second for every control, on one generated program.

Lines, arcs and rapids of a finishing path. ``python -m benchmarks.post --blocks 100000``
"""

import argparse
import time
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from math import pi
from random import Random

from stepnc_model.nc.exact_reading import read
from stepnc_model.post.blocks import (
    Block,
    Circular,
    Linear,
    ProgramEnd,
    ProgramStart,
    Rapid,
    Rate,
    Retract,
    SpindleOn,
    ToolChange,
)
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.dialects import write
from stepnc_model.toolpath.path import Arc


def generate(count: int) -> Iterator[Block]:
    """A program of so many blocks, in the mix of a finishing path."""
    random = Random(14649)
    yield ProgramStart(name="BENCH")
    yield ToolChange(number=1, id="MILL 10MM")
    yield SpindleOn(speed=100.0)
    yield Retract(z=50.0)
    x, y, z = 0.0, 0.0, 50.0
    yield Rapid(end=(x, y, z))
    for _ in range(count - 6):
        kind = random.random()
        rate = Rate(value=random.choice((10.0, 20.0, 25.0)))
        if kind < 0.75:
            x, y, z = (random.uniform(-100.0, 100.0) for _ in "xyz")
            yield Linear(end=(x, y, z), rate=rate)
        elif kind < 0.95:
            centre = (x + random.uniform(1.0, 20.0), y, z)
            x, y = centre[0], y - (centre[0] - x)
            yield Circular(end=(x, y, z), arc=Arc(centre=centre, turn=0.5 * pi), rate=rate)
        else:
            z = 50.0
            yield Rapid(end=(x, y, z))
    yield ProgramEnd()


def seconds(work: Callable[[], Iterable[object]]) -> float:
    """CPU time of using something up."""
    before = time.process_time()
    for _ in work():
        pass
    return time.process_time() - before


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--blocks", type=int, default=100_000)
    count = parser.parse_args(arguments).blocks
    blocks = list(generate(count))
    print(f"{'control':12}{'lines':>9}{'MB':>7}{'written/s':>12}{'read/s':>12}")
    for control in Dialect:
        lines = list(write(blocks, control))
        written = seconds(partial(write, blocks, control))
        taken = seconds(partial(read, lines, control))
        size = sum(len(line) + 1 for line in lines) / 1e6
        print(
            f"{control:12}{len(lines):9}{size:7.1f}"
            f"{count / written:12,.0f}{count / taken:12,.0f}"
        )


if __name__ == "__main__":
    main()
