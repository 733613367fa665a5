"""Material removal: a height map with engagement against solids cut by hulls, in the same run.

Both take a 10 mm end mill through a raster over a wavy surface of a 100 × 100 × 30 mm block in
moves of 0.5 mm. The map (cells of 0.1 mm) also tells section, arcs and chip of each move; the
solids (manifold3d, hull of the tool at both ends of the move, 64 sides) only remove. Then exact
arcs on level moves, in µs a station. ``python -m benchmarks.removal --moves 10000``
"""

import argparse
import itertools
import time
from math import cos, pi, sin

import manifold3d

from simulator.motion.segments import Segments, lines
from simulator.removal.cutter import Cutter
from simulator.removal.engage import MillingStock
from stepnc_model.programs.program import Stock

BLOCK = Stock(low=(0.0, 0.0, -30.0), high=(100.0, 100.0, 0.0))
CELL = 0.1
SIDES = 64
STEP = 0.5
MOST_SOLIDS = 400
"""moves that are cut as solids; each is slower than the one before it"""

TOOLS = {
    "flat": Cutter(diameter=10.0),
    "ball": Cutter(diameter=10.0, corner_radius=5.0),
    "bull-nose": Cutter(diameter=10.0, corner_radius=1.0),
}


def raster(moves: int) -> list[tuple[float, float, float]]:
    """Points of a raster in steps of 0.5 mm over a surface with hills of 1.5 mm."""
    points: list[tuple[float, float, float]] = []
    line = 0
    while len(points) <= moves:
        y = (1.0 * line) % 100.0
        for index in range(201):
            x = STEP * (index if line % 2 == 0 else 200 - index)
            points.append((x, y, -3.0 + 1.5 * sin(x / 12.0) * cos(y / 15.0)))
        line += 1
    return points[: moves + 1]


def spiral(moves: int) -> Segments:
    """A level spiral in steps of 0.5 mm with a step-over of 4 mm."""
    points, angle = [], 0.0
    for _ in range(moves + 1):
        radius = 1.0 + 2.0 * angle / pi
        points.append((50.0 + radius * cos(angle), 50.0 + radius * sin(angle), -2.0))
        angle += STEP / radius
    return lines(points, speed=10.0)


def by_map(path: Segments, cutter: Cutter) -> tuple[float, int]:
    """CPU seconds, and number of stations."""
    stock = MillingStock(BLOCK, cell=CELL)
    start = time.process_time()
    found = stock.cut(path, cutter)
    return time.process_time() - start, len(found)


def by_solids(points: list[tuple[float, float, float]]) -> float:
    """CPU seconds with a flat tool."""
    block = manifold3d.Manifold.cube([100.0, 100.0, 30.0]).translate([0.0, 0.0, -30.0])
    tool = manifold3d.Manifold.cylinder(40.0, 5.0, 5.0, SIDES)
    start = time.process_time()
    for here, there in itertools.pairwise(points):
        block -= manifold3d.Manifold.batch_hull([tool.translate(here), tool.translate(there)])
    block.volume()
    return time.process_time() - start


def main(arguments: list[str] | None = None) -> None:
    """Print moves a second, the ratio, and µs a station."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--moves", type=int, default=10_000)
    options = parser.parse_args(arguments)
    points = raster(options.moves)
    path = lines(points, speed=10.0)
    by_map(path[:2], TOOLS["flat"])
    print(f"{'method':24}{'moves':>8}{'seconds':>10}{'moves/s':>10}{'µs a station':>14}")
    each = {}
    for name, cutter in TOOLS.items():
        count = len(path) if name != "bull-nose" else len(path) // 10
        seconds, stations = by_map(path[:count], cutter)
        each[name] = seconds / count
        _row(f"map, {name}", count, seconds, stations)
    level = spiral(options.moves)
    seconds, stations = by_map(level, TOOLS["flat"])
    _row("map, exact arcs", len(level), seconds, stations)
    some = min(MOST_SOLIDS, options.moves)
    seconds = by_solids(points[: some + 1])
    _row("solids, flat", some, seconds, some)
    ratio = seconds / some / each["flat"]
    print(f"moves a second, map with engagement over solids: {ratio:.0f}")


def _row(name: str, moves: int, seconds: float, stations: int) -> None:
    """Print one method."""
    rate = moves / max(seconds, 1e-9)
    print(f"{name:24}{moves:8}{seconds:10.3f}{rate:10.0f}{1e6 * seconds / stations:14.1f}")


if __name__ == "__main__":
    main()
