"""Turning paths against a sampled lathe: nothing is gouged, all is touched, rapids stay clear.

The lathe here knows nothing of the code under test: it drags a sampled nose over a sampled bar.
"""

from dataclasses import dataclass, field
from itertools import pairwise
from math import atan2, cos, hypot, isfinite, pi, sin, tan
from pathlib import Path

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.arc import points_along
from stepnc_model.toolpath.path import MoveType, Point, ToolPath
from stepnc_model.toolpath.task import job_of
from stepnc_model.toolpath.turning.offset import grown
from stepnc_model.toolpath.turning.operation import turning_path
from stepnc_model.toolpath.turning.profile import ProfilePiece, arc_pieces, highest

Floats = NDArray[np.float64]

SHAFT = Path(__file__).parents[2] / "examples" / "parts" / "shaft.stpnc"
CELL = 0.1
"""mm of z"""
STEP = 0.1
"""mm between two positions of the nose"""
TOLERANCE = 0.02
"""mm; what the sampling costs"""
BAR = 30.0
LOW, HIGH = -150.0, 2.0


@dataclass
class Lathe:
    """A bar as radii in cells of z."""

    nose: float
    z: Floats = field(default_factory=lambda: np.arange(LOW, HIGH + CELL / 2, CELL))
    radius: Floats = field(init=False)
    worst_rapid: float = 0.0

    def __post_init__(self) -> None:
        self.radius = np.full(len(self.z), BAR)

    def run(self, path: ToolPath) -> None:
        for start, move in path.segments():
            points = [start, *points_along(start, move, step=pi / 180)]
            # In rapid the nose is thicker: a clearance of 1 mm, less the sampling.
            lower = self.swept(points, self.nose + (0.95 if move.feed is None else 0.0))
            if move.feed is None:
                self.worst_rapid = max(self.worst_rapid, float(np.max(self.radius - lower)))
            else:
                self.radius = np.minimum(self.radius, lower)

    def swept(self, points: list[Point], size: float) -> Floats:
        """Lowest radius that the nose comes to over each cell."""
        positions: list[tuple[float, float]] = []
        for a, b in pairwise(points):
            count = max(1, int(hypot(b[0] - a[0], b[2] - a[2]) / STEP) + 1)
            positions += [
                (a[0] + (b[0] - a[0]) * i / count, a[2] + (b[2] - a[2]) * i / count)
                for i in range(count + 1)
            ]
        lower = np.full(len(self.z), np.inf)
        if not positions:
            return lower
        x, z = np.array(positions).T + self.nose
        reach = int(size / CELL) + 1
        cells = np.rint((z - LOW) / CELL).astype(int)[:, None] + np.arange(-reach, reach + 1)
        is_on = (cells >= 0) & (cells < len(self.z))
        inside = size**2 - (LOW + cells * CELL - z[:, None]) ** 2
        is_on &= inside >= 0.0
        bottoms = x[:, None] - np.sqrt(np.maximum(inside, 0.0))
        np.minimum.at(lower, cells[is_on], bottoms[is_on])
        return lower


@dataclass(frozen=True)
class Contour:
    """Corners (z, x) from the front to the chuck, and the radius of a nose."""

    corners: tuple[tuple[float, float], ...]
    nose: float
    allowance: float
    depth: float
    is_to_and_fro: bool
    is_along: bool
    bends: tuple[float, ...]
    """rad by which each line turns; 0 where it is straight"""
    ways: str
    """lift, back path and step over, and the height of the lift, as the strategy has them"""

    def spots(self) -> list[tuple[float, float]]:
        """Corners, and points of the arcs between them."""
        found = [self.corners[0]]
        for start, end, bend in zip(self.corners, self.corners[1:], self.bends, strict=False):
            if bend:
                z, x = centre_of(start, end, bend)
                size, first = (
                    hypot(start[0] - z, start[1] - x),
                    atan2(start[1] - x, start[0] - z),
                )
                angles = [first + bend * i / 100 for i in range(1, 100)]
                found += [(z + size * cos(at), x + size * sin(at)) for at in angles]
            found.append(end)
        return found

    def radius(self, z: Floats, *, beyond: float = -1e-9) -> Floats:
        """Largest radius at each z; −inf beside the contour.

        Corners belong to no line, or to both where lines count a little beyond their ends.
        """
        found = np.full(len(z), -np.inf)
        for (a, b), (c, d) in pairwise(self.spots()):
            if abs(a - c) > 1e-9:
                is_on = (z < max(a, c) + beyond) & (z > min(a, c) - beyond)
                found[is_on] = np.maximum(found[is_on], b + (d - b) * (z[is_on] - a) / (c - a))
        return found


def centre_of(
    start: tuple[float, float], end: tuple[float, float], bend: float
) -> tuple[float, float]:
    """Centre of an arc that turns by an angle, counter-clockwise positive."""
    away = 0.5 / tan(0.5 * bend)
    return (
        0.5 * (start[0] + end[0]) - away * (end[1] - start[1]),
        0.5 * (start[1] + end[1]) + away * (end[0] - start[0]),
    )


steps = st.tuples(st.integers(0, 200), st.integers(-40, 80))
"""length and rise of one line, in tenths of a millimetre"""


WAYS = (
    "$,$,$,$",
    "#501,#502,#506,1.",
    "#501,$,#506,2.",
    "#911,#502,$,2.",
    "#911,#912,#913,3.",
    "#501,#913,#504,0.01",
    "#506,#506,#502,2.",
)
"""the last two make no sense: a step over along the feed, and all of them the wrong way"""
OBLIQUE = """
#911=DIRECTION('BACK, RISING',(0.1,0.,1.));
#912=DIRECTION('OUT AND BACK',(1.,0.,0.4));
#913=DIRECTION('IN AND TO THE CHUCK',(-1.,0.,-0.3));
"""


@st.composite
def contours(draw: st.DrawFn, *, is_monotone: bool) -> Contour:
    corners = [(0.0, draw(st.integers(80, 150)) / 10.0)]
    for length, rise in draw(st.lists(steps, min_size=1, max_size=6)):
        z, x = corners[-1]
        up = abs(rise) if is_monotone else rise
        point = (round(z - length / 10.0, 3), round(min(29.0, max(5.0, x + up / 10.0)), 3))
        if hypot(point[0] - z, point[1] - x) > 0.5:
            corners.append(point)
    z, x = corners[-1]
    corners.append((round(z - 10.0, 3), x))
    # Further out an arc would bulge out of the bar.
    sizes = (
        st.just(0.0)
        if is_monotone or max(x for _, x in corners) > 26.0
        else st.sampled_from([0.0, 0.5, 1.0, -0.5, -1.0])
    )
    bends = [draw(sizes) if abs(a[0] - b[0]) > 1.0 else 0.0 for a, b in pairwise(corners[:-1])]
    return Contour(
        corners=tuple(corners),
        nose=draw(st.sampled_from([0.2, 0.4, 0.8, 1.2])),
        allowance=draw(st.sampled_from([0.2, 0.5])),
        depth=draw(st.sampled_from([0.7, 1.5, 3.0])),
        is_to_and_fro=draw(st.booleans()),
        is_along=draw(st.booleans()),
        bends=(*bends, 0.0),
        ways=draw(st.sampled_from(WAYS)),
    )


def curve_of(contour: Contour) -> str:
    """A composite curve of its lines and arcs."""
    names, lines = [], ["#920=DIRECTION('',(0.,1.,0.));\n#921=DIRECTION('',(0.,-1.,0.));"]
    for i, (z, x) in enumerate(contour.corners):
        lines.append(f"#{1000 + i}=CARTESIAN_POINT('',({x!r},0.,{z!r}));")
    for i, bend in enumerate(contour.bends):
        at, ends = 2000 + 10 * i, (contour.corners[i], contour.corners[i + 1])
        names.append(f"#{at}")
        lines.append(f"#{at}=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#{at + 1});")
        if not bend:
            lines.append(f"#{at + 1}=POLYLINE('',(#{1000 + i},#{1001 + i}));")
            continue
        z, x = centre_of(*ends, bend)
        size = hypot(ends[0][0] - z, ends[0][1] - x)
        trims = f"(#{1000 + i}),(#{1001 + i})"
        lines += [
            f"#{at + 1}=TRIMMED_CURVE('',#{at + 2},{trims},.T.,.CARTESIAN.);",
            f"#{at + 2}=CIRCLE('',#{at + 3},{size!r});",
            f"#{at + 3}=AXIS2_PLACEMENT_3D('',#{at + 4},#{920 if bend > 0.0 else 921},#502);",
            f"#{at + 4}=CARTESIAN_POINT('',({x!r},0.,{z!r}));",
        ]
    return f"#112=COMPOSITE_CURVE('',({','.join(names)}),.F.);\n" + "\n".join(lines)


def program_of(contour: Contour) -> Program:
    """The shaft with this contour instead of its own, and no face in front of it."""
    back, lift, stepover, height = contour.ways.split(",")
    start = f"(1.,.T.,({contour.depth!r}),$,#504,"
    to_and_fro = f"BIDIRECTIONAL_TURNING{start}{stepover},$);"
    along = f"CONTOUR_TURNING{start}{back},{lift},{stepover},{height},$,$,$);"
    scan = f"UNIDIRECTIONAL_TURNING{start}{back},{lift},{stepover},{height},$,$);"
    strategy = to_and_fro if contour.is_to_and_fro else along if contour.is_along else scan
    edits = (
        ("#112=POLYLINE('CONTOUR',(#113,#114,#115,#116,#117,#118,#119));",
         curve_of(contour) + OBLIQUE),
        ("#352=UNIDIRECTIONAL_TURNING(1.,.T.,(2.),$,#504,#501,#502,#506,1.,$,$);",
         f"#352={strategy}"),
        ("(#10,#11,#12,#13)", "(#12,#13)"),
        ("(#3,#4)", "(#3)"),
        ("#43,(#110,#120),#202", "#43,(#110),#202"),
        ("#43,(#110,#120),#203", "#43,(#110),#203"),
        ("#330,$,$,#352,0.5)", f"#330,$,$,#352,{contour.allowance!r})"),
        ("ROUNDED_CORNER(0.8);\n#410", f"ROUNDED_CORNER({contour.nose!r});\n#410"),
        ("#412=ROUNDED_CORNER(0.8)", f"#412=ROUNDED_CORNER({contour.nose!r})"),
    )  # fmt: skip
    text = SHAFT.read_text()
    for before, after in edits:
        assert before in text, before
        text = text.replace(before, after)
    return Program(Part21File.from_bytes(text.encode()))


def rough_and_finish(contour: Contour) -> tuple[ToolPath, ToolPath]:
    program = program_of(contour)
    rough, finish = (turning_path(job_of(program, step)) for step in program.workingsteps)
    return rough, finish


def rolled(contour: Contour, z: Floats) -> Floats:
    """Surface that a nose leaves when it rolls over the contour and the bar behind it."""
    target = contour.radius(z, beyond=1e-9)
    target[z < contour.corners[-1][0] - 1e-9] = BAR
    reach = int(contour.nose / CELL)
    offsets = np.arange(-reach, reach + 1)
    ball = np.sqrt(np.maximum(0.0, contour.nose**2 - (offsets * CELL) ** 2))
    centre = np.full(len(z), -np.inf)
    for offset, height in zip(offsets, ball, strict=True):
        moved = np.roll(target, offset) + height
        centre = np.maximum(centre, moved)
    left = np.full(len(z), np.inf)
    for offset, height in zip(offsets, ball, strict=True):
        left = np.minimum(left, np.roll(centre, offset) - height)
    return left


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(contours(is_monotone=False))
def test_no_pass_gouges_and_no_rapid_touches(contour: Contour) -> None:
    rough, finish = rough_and_finish(contour)
    lathe = Lathe(nose=contour.nose)
    lathe.run(rough)
    target = contour.radius(lathe.z)
    assert np.min(lathe.radius - target) > contour.allowance - 0.5 * contour.allowance
    lathe.run(finish)
    assert np.min(lathe.radius - target) > -TOLERANCE
    assert lathe.worst_rapid < TOLERANCE
    behind = lathe.z < contour.corners[-1][0] - 1e-9
    assert np.min(lathe.radius[behind]) == BAR


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(contours(is_monotone=True))
def test_a_finish_touches_all_that_the_nose_can_reach(contour: Contour) -> None:
    lathe = Lathe(nose=contour.nose)
    for path in rough_and_finish(contour):
        lathe.run(path)
    inside = (lathe.z <= -contour.nose) & (lathe.z >= contour.corners[-1][0])
    left = rolled(contour, lathe.z)
    # Beside a wall a cell is as good as its neighbours.
    left = np.maximum(left, np.maximum(np.roll(left, 1), np.roll(left, -1)))
    assert np.max(lathe.radius[inside] - left[inside]) < TOLERANCE


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(contours(is_monotone=False))
def test_paths_are_finite_and_end_where_they_start(contour: Contour) -> None:
    for path in rough_and_finish(contour):
        assert all(isfinite(c) for move in path.moves for c in move.end)
        assert path.end == path.start
        assert any(move.type is MoveType.CONTACT for move in path.moves)


@st.composite
def surfaces(draw: st.DrawFn) -> list[ProfilePiece]:
    """Lines and arcs, one after the other towards +u."""
    spot = (0.0, 10.0)
    pieces: list[ProfilePiece] = []
    for _ in range(draw(st.integers(1, 6))):
        end = (spot[0] + draw(st.integers(5, 60)) / 10.0, draw(st.integers(50, 150)) / 10.0)
        bend = draw(st.sampled_from([0.0, 0.6, 1.2, -0.6, -1.2]))
        if bend == 0.0:
            pieces.append(ProfilePiece(start=spot, end=end))
        else:
            middle = (0.5 * (spot[0] + end[0]), 0.5 * (spot[1] + end[1]))
            away = 0.5 / tan(0.5 * bend)
            centre = (
                middle[0] - away * (end[1] - spot[1]),
                middle[1] + away * (end[0] - spot[0]),
            )
            pieces += arc_pieces(spot, end, centre=centre, turn=bend)
        spot = end
    return pieces


@settings(max_examples=100, deadline=None)
@given(surfaces(), st.sampled_from([0.2, 0.8, 2.0]))
def test_a_grown_surface_is_where_a_rolling_disc_has_its_centre(
    pieces: list[ProfilePiece], radius: float
) -> None:
    """Against every spot of the surface, sampled: the highest disc about any of them."""
    spots = np.array([piece.point(i / 200.0) for piece in pieces for i in range(201)])
    centres = grown(highest(pieces), radius)
    for u in np.linspace(spots[:, 0].min() + 0.01, spots[:, 0].max() - 0.01, 60):
        beside = spots[:, 0] - u
        near = np.abs(beside) <= radius
        sampled = np.max(spots[near, 1] + np.sqrt(radius**2 - beside[near] ** 2))
        assert abs(sampled - centres.at(float(u))) < 0.05
        assert sampled <= centres.at(float(u)) + 1e-6
