"""200 pockets with islands, cleared by rings: exact arcs against a plain pyclipper pipeline.

Both get the same walls, cutters and steps and write a line of G code for each edge. pyclipper
works on polygons whose chords stay within 0.001 mm, and leaves uncut what rings leave; ours
adds passes there. ``python -m benchmarks.pockets --pockets 200``
"""

import argparse
import time
from cmath import rect
from collections.abc import Iterator
from dataclasses import dataclass
from math import pi
from random import Random

import pyclipper

from stepnc_model.toolpath.milling.contour import (
    ContourEdge,
    Loop,
    circle,
    clockwise,
    polygon,
    vertices,
)
from stepnc_model.toolpath.milling.cover import rings
from stepnc_model.toolpath.milling.offset import rounded

CHORD = 1e-3
"""mm of tolerance of the polygons"""

SCALE = 1e5
"""units of pyclipper in a mm"""


@dataclass(frozen=True, slots=True)
class StarPocket:
    """Walls, cutter and step."""

    walls: tuple[Loop, ...]
    radius: float
    step: float


def pockets(count: int) -> Iterator[StarPocket]:
    """Star-shaped pockets with rounded corners and round islands, always the same ones."""
    random = Random(14649)
    while count:
        sides = random.randint(4, 8)
        corners = [rect(random.uniform(35.0, 70.0), 2.0 * pi * k / sides) for k in range(sides)]
        radius = random.uniform(3.0, 6.0)
        outline = rounded(polygon(corners), radius)
        if len(outline) != 1:
            continue
        angle = random.uniform(0.0, 2.0 * pi)
        islands = [
            clockwise(circle(rect(14.0, angle + k * pi), random.uniform(2.0, 5.0)))
            for k in range(random.randint(1, 2))
        ]
        step = random.uniform(0.4, 1.4) * radius
        yield StarPocket((outline[0], *islands), radius, step)
        count -= 1


def by_arcs(pocket: StarPocket) -> list[str]:
    """Rings of lines and arcs."""
    passes = rings(pocket.walls, distance=pocket.radius, radius=pocket.radius, step=pocket.step)
    return [code(edge) for each in passes for edge in each.chain]


def code(edge: ContourEdge) -> str:
    """One line of G code."""
    end = edge.end
    if edge.centre is None:
        return f"G1 X{end.real:.4f} Y{end.imag:.4f}"
    word = "G3" if edge.turn > 0.0 else "G2"
    to_centre = edge.centre - edge.start
    return f"{word} X{end.real:.4f} Y{end.imag:.4f} I{to_centre.real:.4f} J{to_centre.imag:.4f}"


def by_clipper(pocket: StarPocket) -> list[str]:
    """Rings of chords."""
    offset = pyclipper.PyclipperOffset(2.0, CHORD * SCALE)
    for wall in pocket.walls:
        points = vertices(wall, tolerance=CHORD)
        path = [(round(p.real * SCALE), round(p.imag * SCALE)) for p in points]
        offset.AddPath(path, pyclipper.JT_ROUND, pyclipper.ET_CLOSEDPOLYGON)
    lines: list[str] = []
    distance = pocket.radius
    while True:
        found = offset.Execute(-distance * SCALE)
        if not found:
            return lines
        for path in found:
            lines += [f"G1 X{x / SCALE:.4f} Y{y / SCALE:.4f}" for x, y in path]
        distance += pocket.step


def main(arguments: list[str] | None = None) -> None:
    """Print CPU seconds, lines, and both ratios."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pockets", type=int, default=200)
    options = parser.parse_args(arguments)
    work = list(pockets(options.pockets))
    print(f"{'method':28}{'seconds':>10}{'ms each':>10}{'lines':>10}")
    seconds, lines = [], []
    for name, make in (("exact arcs", by_arcs), ("pyclipper, chords", by_clipper)):
        make(work[0])
        start = time.process_time()
        lines.append(sum(len(make(pocket)) for pocket in work))
        seconds.append(time.process_time() - start)
        each = 1e3 * seconds[-1] / len(work)
        print(f"{name:28}{seconds[-1]:10.3f}{each:10.2f}{lines[-1]:10}")
    print(
        f"time, arcs over chords: {seconds[0] / seconds[1]:.2f}; "
        f"lines, arcs over chords: 1/{lines[1] / lines[0]:.1f}"
    )


if __name__ == "__main__":
    main()
