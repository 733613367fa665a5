"""Grooving, cutting off and threading against a sampled lathe with inserts of their own shape.

The lathe here knows nothing of the code under test: it drags a sampled insert over a sampled
bar, the seat of 30 mm of the shaft with its shoulder and what else earlier work has left.
"""

from dataclasses import dataclass
from itertools import pairwise
from math import cos, hypot, pi, radians, sin, sqrt, tan
from pathlib import Path

import numpy as np
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.arc import points_along
from stepnc_model.toolpath.path import Move, MoveType, Point, ToolPath
from stepnc_model.toolpath.task import job_of
from stepnc_model.toolpath.turning.operation import turning_path

Floats = NDArray[np.float64]

SHAFT = Path(__file__).parents[2] / "examples" / "parts" / "shaft.stpnc"
CELL = 0.04
"""mm of z"""
STEP = 0.05
"""mm between two positions of an insert"""
TOLERANCE = 0.02
"""mm; what the sampling costs"""
ROOM = 0.95
"""mm around an insert in rapid: its clearance less the sampling"""
Z = np.arange(-46.0, 6.0 + CELL / 2, CELL)

MANY = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])


def seat() -> Floats:
    """The shaft when its contour is done with a nose of 0.8 mm."""
    left = np.where(Z < -40.0 - CELL, 20.0, 15.0)
    left = np.where(Z > -1.5, 13.5 - Z, left)
    fillet = 15.8 - np.sqrt(np.maximum(0.0, 0.64 - np.maximum(0.0, -39.2 - Z) ** 2))
    left = np.where((Z >= -40.0) & (Z < -39.2), fillet, left)
    return np.where(Z > 0.0, -1e3, left)


def path_of(name: str, edits: list[tuple[str, str]]) -> ToolPath:
    """Path of a workingstep of the shaft with some text replaced."""
    text = SHAFT.read_text()
    for before, after in edits:
        assert before in text, before
        text = text.replace(before, after)
    program = Program(Part21File.from_bytes(text.encode()))
    (step,) = (step for step in program.workingsteps if step.id == name)
    return turning_path(job_of(program, step))


def positions(start: Point, move: Move) -> Floats:
    """Radius and z of the programmed point along a move, (N, 2)."""
    found: list[tuple[float, float]] = []
    for a, b in pairwise([start, *points_along(start, move, step=pi / 180)]):
        count = max(1, int(hypot(b[0] - a[0], b[2] - a[2]) / STEP) + 1)
        found += [
            (a[0] + (b[0] - a[0]) * i / count, a[2] + (b[2] - a[2]) * i / count)
            for i in range(count + 1)
        ]
    return np.array(found)


def swept(spots: Floats, offsets: Floats, heights: Floats) -> Floats:
    """Lowest radius over each cell that a shape comes to; offsets along z, (M,)."""
    lower = np.full(len(Z), np.inf)
    cells = np.rint((spots[:, 1:] + offsets - Z[0]) / CELL).astype(int)
    is_on = (cells >= 0) & (cells < len(Z))
    np.minimum.at(lower, cells[is_on], (spots[:, :1] + heights)[is_on])
    return lower


@dataclass(frozen=True)
class Shape:
    """Lower edge of an insert over z, from its programmed point."""

    offsets: Floats
    heights: Floats

    def thick(self) -> "Shape":
        """With room around it."""
        wide = np.arange(self.offsets[0] - ROOM, self.offsets[-1] + ROOM, CELL)
        return Shape(wide, np.full(len(wide), float(np.min(self.heights)) - ROOM))


def lifted(radii: Floats) -> Floats:
    """The highest of each cell and its neighbours: beside a wall one is as good as the next."""
    return np.maximum(radii, np.maximum(np.roll(radii, 1), np.roll(radii, -1)))


def insert(width: float, corner: float) -> Shape:
    """A flat with two rounded corners; its left one is the programmed point."""
    offsets = np.linspace(0.0, width, 2 * round(width / CELL) + 1)
    beside = np.maximum(0.0, corner - np.minimum(offsets, width - offsets))
    return Shape(offsets, corner - np.sqrt(np.maximum(0.0, corner**2 - beside**2)))


def run(path: ToolPath, shape: Shape, left: Floats) -> Floats:
    """What is left of a bar; no rapid may come near to it."""
    for start, move in path.segments():
        spots = positions(start, move)
        if move.feed is None:
            thick = shape.thick()
            lower = swept(spots, thick.offsets, thick.heights)
            assert np.max(left - lower) < TOLERANCE, f"rapid to {move.end}"
            continue
        lower = swept(spots, shape.offsets, shape.heights)
        cut = np.max(left - lower)
        if move.type is MoveType.NO_CONTACT:
            assert cut < TOLERANCE, f"cuts {cut} mm in no contact to {move.end}"
        left = np.minimum(left, lower)
    return left


@dataclass(frozen=True)
class Groove:
    """A groove about z = −22 mm, and how it is cut."""

    profile: str
    lines: str
    target: Floats
    half: float
    """mm, of its level floor"""
    depth: float
    width: float
    corner: float
    """of the insert"""
    strategy: str
    allowance: float


MIDDLE = -22.0
STRATEGIES = (
    "GROOVING_STRATEGY($,.T.,(),$,#506,$)",
    "GROOVING_STRATEGY($,.T.,(),$,#504,$)",
    "GROOVING_STRATEGY($,.T.,(),$,#501,$)",
    "GROOVING_STRATEGY($,.T.,(),$,$,0.7)",
    "MULTISTEP_GROOVING_STRATEGY($,.T.,(0.8),$,#501,$,0.3)",
    "MULTISTEP_GROOVING_STRATEGY($,.T.,(1.,0.5),$,$,1.2,0.)",
)


@st.composite
def grooves(draw: st.DrawFn) -> Groove:
    depth = draw(st.integers(5, 60)) / 10.0
    size = draw(st.integers(20, 100)) / 10.0
    beside, bottom = np.abs(Z - MIDDLE), 15.0 - depth
    kind = draw(st.sampled_from(["square", "round", "vee", "bowl"]))
    half = 0.0
    if kind == "square":
        lean = [draw(st.sampled_from([0.0, 5.0, 20.0])) for _ in range(2)]
        fillet = min(draw(st.sampled_from([0.0, 0.3, 0.8])), 0.5 * size)
        half = 0.5 * size
        slope = np.where(Z > MIDDLE, tan(radians(lean[0])), tan(radians(lean[1])))
        past = np.maximum(0.0, beside - half)
        rise = np.where(past > 0.0, past / np.maximum(slope, 1e-9), 0.0)
        foot = np.maximum(0.0, beside - half + fillet)
        round_foot = fillet - np.sqrt(np.maximum(0.0, fillet**2 - foot**2))
        # In front of a leaning wall the fillet is larger: this is what is never too much.
        target = bottom + np.where(past > 0.0, rise, np.where(slope > 0.0, 0.0, round_foot))
        profile = f"SQUARE_U_PROFILE($,#900,#901,{lean[0]!r},#901,{lean[1]!r})"
        half -= fillet * 1.5
    elif kind == "round":
        radius, fillet = 0.5 * size, 0.0
        inside = np.sqrt(np.maximum(0.0, radius**2 - beside**2))
        target = np.where(beside <= radius, bottom + radius - inside, np.inf)
        profile = "ROUNDED_U_PROFILE($,#900)"
    elif kind == "vee":
        fillet, angle = draw(st.sampled_from([0.0, 0.5])), draw(st.sampled_from([60.0, 110.0]))
        wing = radians(0.5 * angle)
        apex = bottom - fillet * (1.0 / sin(wing) - 1.0)
        arc = bottom + fillet - np.sqrt(np.maximum(0.0, fillet**2 - beside**2))
        target = np.where(beside < fillet * cos(wing), arc, apex + beside / tan(wing))
        profile = f"VEE_PROFILE($,#901,{angle!r},0.)"
    else:
        radius, fillet = max(size, depth + 0.1), 0.0
        inside = np.sqrt(np.maximum(0.0, radius**2 - beside**2))
        target = np.where(beside <= radius, bottom + radius - inside, np.inf)
        profile = "PARTIAL_CIRCULAR_PROFILE($,#902,180.)"
        size = radius
    width = draw(st.integers(12, 40)) / 10.0
    return Groove(
        profile=profile,
        lines=f"#900=TOLERANCED_LENGTH_MEASURE({size!r},#510);\n"
        f"#901=TOLERANCED_LENGTH_MEASURE({fillet!r},#510);\n"
        f"#902=TOLERANCED_LENGTH_MEASURE({size!r},#510);\nENDSEC;\nEND-",
        target=target,
        half=half,
        depth=depth,
        width=width,
        corner=draw(st.sampled_from([0.0, 0.2, 0.4])),
        strategy=draw(st.sampled_from(STRATEGIES)),
        allowance=draw(st.sampled_from([0.0, 0.2])),
    )


def groove_path(groove: Groove, operation: str) -> ToolPath:
    """Its path; a draw whose insert does not fit is none."""
    allowance = groove.allowance if operation == "GROOVING_ROUGH" else 0.0
    edits = [
        ("(0.,0.,-27.)", f"(0.,0.,{MIDDLE!r})"),
        ("#505,12.5,", f"#505,{15.0 - groove.depth!r},"),
        ("SQUARE_U_PROFILE($,#134,#135,0.,#135,0.)", groove.profile),
        ("ENDSEC;\nEND-", groove.lines),
        (".RIGHT.,3.,12.,0.2", f".RIGHT.,{groove.width!r},12.,{groove.corner!r}"),
        ("GROOVING_STRATEGY($,.T.,(),$,#506,$)", groove.strategy),
        ("#204=GROOVING_ROUGH", f"#204={operation}"),
        ("#354,$,0.)", f"#354,$,{allowance!r})"),
    ]
    try:
        return path_of("THREAD RELIEF", edits)
    except PathError as error:
        assume("too narrow" not in str(error) and "nothing to remove" not in str(error))
        raise


@MANY
@given(grooves())
def test_plunges_leave_the_groove_and_its_allowance(groove: Groove) -> None:
    path = groove_path(groove, "GROOVING_ROUGH")
    left = run(path, insert(groove.width, groove.corner), seat())
    assert np.min(left + lifted(-np.minimum(groove.target, seat()))) > -TOLERANCE
    floor = np.abs(Z - MIDDLE) < groove.half
    if np.any(floor):
        assert np.min(left[floor] - groove.target[floor]) > groove.allowance - TOLERANCE


@MANY
@given(grooves())
def test_a_finish_leaves_the_groove_as_drawn(groove: Groove) -> None:
    shape = insert(groove.width, groove.corner)
    left = run(groove_path(groove, "GROOVING_ROUGH"), shape, seat())
    left = run(groove_path(groove, "GROOVING_FINISH"), shape, left)
    assert np.min(left + lifted(-np.minimum(groove.target, seat()))) > -TOLERANCE
    inner = groove.half - groove.corner - 2.0 * CELL
    floor = np.abs(Z - MIDDLE) < inner
    if np.any(floor) and inner > 0.5 * groove.width:
        assert np.max(left[floor] - groove.target[floor]) < TOLERANCE


@MANY
@given(st.integers(10, 40), st.sampled_from([0.0, 0.2, 0.4]), st.integers(0, 120))
def test_cutting_off_leaves_the_part_in_front_and_behind(
    width: int, corner: float, radius: int
) -> None:
    edits = [
        ("#204=GROOVING_ROUGH", "#204=CUTTING_IN"),
        ("#505,12.5,", f"#505,{radius / 10.0!r},"),
        ("(0.,0.,-27.)", f"(0.,0.,{MIDDLE!r})"),
        ("LENGTH_MEASURE(4.,", f"LENGTH_MEASURE({width / 10.0!r},"),
        (".RIGHT.,3.,12.,0.2", f".RIGHT.,{width / 10.0!r},20.,{corner!r}"),
    ]
    left = run(path_of("THREAD RELIEF", edits), insert(width / 10.0, corner), seat())
    beside = np.abs(Z - MIDDLE) > width / 20.0 + CELL
    assert np.max(np.abs(left[beside & (Z < 0.0)] - seat()[beside & (Z < 0.0)])) < 1e-9
    assert abs(left[np.abs(Z - MIDDLE) < CELL][0] - radius / 10.0) < 0.4 + TOLERANCE


@dataclass(frozen=True)
class Thread:
    """A thread of the seat, and how it is cut."""

    pitch: float
    depths: str
    direction: str
    function: str
    hand: str
    overcut: str
    angle: str
    length: float
    operation: str
    has_relief: bool


@st.composite
def threads(draw: st.DrawFn) -> Thread:
    pitch = draw(st.sampled_from([0.5, 1.0, 1.5, 2.0, 3.0]))
    sizes = draw(st.lists(st.integers(2, 20), max_size=6))
    return Thread(
        pitch=pitch,
        depths=",".join(repr(size / 100.0) for size in sizes),
        direction=draw(
            st.sampled_from(["LEFT", "RIGHT", "CENTER", "LEFT_ZIGZAG", "RIGHT_ZIGZAG"])
        ),
        function=draw(st.sampled_from(["CONSTANT_DEPTH", "CONSTANT_REMOVAL_AMOUNT"])),
        hand=draw(st.sampled_from(["LEFT", "RIGHT"])),
        overcut=draw(st.sampled_from(["$", "0.", "1.", "4."])),
        angle=draw(st.sampled_from(["$", "30.", "45.", "90."])),
        length=draw(st.sampled_from([12.0, 25.0, 38.0, 40.0])),
        operation=draw(st.sampled_from(["THREADING_ROUGH", "THREADING_FINISH"])),
        has_relief=draw(st.booleans()),
    )


def thread_path(thread: Thread) -> ToolPath:
    """Path of a thread of the shaft."""
    pitch, length = repr(thread.pitch), repr(thread.length)
    depths = "(0.434,0.18,0.138,0.116,0.102,0.093,0.085,0.079)"
    edits = [
        ("THREAD_STRATEGY(2.", f"THREAD_STRATEGY({thread.overcut}"),
        (depths, f"({thread.depths})"),
        (".CONSTANT_REMOVAL_AMOUNT.,.RIGHT.,$", f".{thread.function}.,.{thread.direction}.,"
         f"{thread.angle}"),
        (".RIGHT.,2.,\n     .RIGHT.", f".RIGHT.,{pitch},\n     .{thread.hand}."),
        (".TCP.,#313,2.,", f".TCP.,#313,{pitch},"),
        ("#142=TOLERANCED_LENGTH_MEASURE(25.", f"#142=TOLERANCED_LENGTH_MEASURE({length}"),
        ("#205=THREADING_ROUGH", f"#205={thread.operation}"),
    ]  # fmt: skip
    if not thread.has_relief:
        edits.append(("(#14,#15)", "(#15)"))
    return path_of("THREAD M30 X 2", edits)


@MANY
@given(threads())
def test_a_thread_is_cut_on_its_seat_and_nowhere_else(thread: Thread) -> None:
    """The tip of a vee of 60°, half a pitch wide on each side, leaves the rest as it was."""
    path = thread_path(thread)
    offsets = np.arange(-0.5 * thread.pitch, 0.5 * thread.pitch + CELL / 4, CELL / 2)
    vee = Shape(offsets, np.abs(offsets) * sqrt(3.0))
    before = seat()
    if thread.has_relief:
        before = np.where((Z > -29.0) & (Z < -25.0), 12.5, before)
    depth = 15.0 - min(m.end[0] for m in path.moves)
    left = before
    for start, move in path.segments():
        lower = swept(positions(start, move), vee.offsets, vee.heights)
        if move.feed is not None:
            left = np.minimum(left, lower)
        else:
            assert np.max(left - lower) < TOLERANCE, f"rapid to {move.end}"
    sizes = [float(size) for size in thread.depths.split(",") if size]
    full = sum(sizes) if len(sizes) > 1 else 0.61343 * thread.pitch
    assert depth < full + 1e-4
    assert np.min(left[Z < 0.0] - np.minimum(before, 15.0 - full)[Z < 0.0]) > -TOLERANCE
    # A left-hand thread may begin further out by what its passes shift along the flank.
    shifted = 0.36 * thread.pitch if thread.hand == "LEFT" else 0.0
    flank = depth / sqrt(3.0) + shifted + 2.0 * CELL
    beyond = Z + thread.length + flank < 0.0
    if thread.has_relief:
        beyond &= Z < -29.0 - CELL
    if thread.hand == "RIGHT" or thread.length != 38.0:
        assert np.max(before[beyond] - left[beyond]) < TOLERANCE
    assert np.max((before - left)[Z < -40.0 - CELL]) < TOLERANCE


@MANY
@given(threads())
def test_what_a_thread_calls_air_is_air(thread: Thread) -> None:
    path = thread_path(thread)
    before = seat()
    if thread.has_relief:
        before = np.where((Z > -29.0) & (Z < -25.0), 12.5, before)
    for start, move in path.segments():
        x, z = positions(start, move).T[:, 1:-1]
        cells = np.clip(np.rint((z - Z[0]) / CELL).astype(int), 0, len(Z) - 1)
        if move.type is MoveType.NO_CONTACT:
            assert np.all(x > -lifted(-before)[cells] - CELL)
        if move.type is MoveType.CONTACT:
            assert np.all(x < lifted(before)[cells] + CELL)
