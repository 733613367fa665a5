"""The oracle of NC code, and programs that all dialects are tried on.

LinuxCNC's stand-alone interpreter is fetched from Debian into ``build/cache``, unpacked there
and run as a program of its own. Where that is not possible, what needs it is skipped.
"""

import os
import platform
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterable
from math import atan2, cos, hypot, pi, sin
from pathlib import Path

import pytest
from hypothesis import strategies as st

from stepnc_model.post.blocks import (
    Block,
    Circular,
    Comment,
    Coolant,
    CoolantKind,
    DrillingCycle,
    Linear,
    MachineType,
    Message,
    OptionalStopBlock,
    Pause,
    ProgramEnd,
    ProgramStart,
    ProgramStopBlock,
    Rapid,
    Rate,
    RateMode,
    Retract,
    RigidTap,
    SpindleDirection,
    SpindleOff,
    SpindleOn,
    SpindleOrient,
    SurfaceSpeed,
    ThreadingMove,
    ToolChange,
    expanded,
)
from stepnc_model.post.canonical import Canonical, read
from stepnc_model.post.grid import LEAST_RADIUS
from stepnc_model.toolpath.path import Arc, ArcPlane, CycleKind, Point

PACKAGES = ("linuxcnc-uspace", "libboost-python1.74.0")
CACHE = Path(__file__).parents[3] / "build" / "cache"
PLACE = CACHE / "linuxcnc"
SETTINGS = (
    "[EMC]\nMACHINE=mill\n[RS274NGC]\nPARAMETER_FILE=rs.var\n"
    "[TRAJ]\nLINEAR_UNITS=mm\nANGULAR_UNITS=degree\nCOORDINATES=XYZ\nAXES=3\n"
    "[EMCIO]\nTOOL_TABLE=tool.tbl\n"
)
# The table is read in inches: lengths of 0 mean the same in all units.
TOOLS = "".join(f"T{number} P{number} Z0 D0.4\n" for number in range(1, 21))

Interpreter = Callable[[Iterable[str]], tuple[Canonical, ...]]

PER_MINUTE = Rate(value=5.0)
FASTER = Rate(value=12.5)
PER_REVOLUTION = Rate(value=0.2, mode=RateMode.PER_REVOLUTION)
CLEARANCE = 0.254
SPINDLE = SpindleOn(speed=20.0)


def _run(*command: str, folder: Path) -> str:
    """Output of a command, or a skip that says what failed."""
    try:
        answer = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, timeout=300, check=False
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        pytest.skip(f"rs274 is not here: {error}")
    if answer.returncode:
        last = (answer.stderr.strip() or answer.stdout.strip()).splitlines()[-1:]
        pytest.skip(f"rs274 is not here: {command[0]}: {' '.join(last)}")
    return answer.stdout


def _fetch() -> None:
    """Download and unpack, then rename: of several workers one wins, none sees a half."""
    CACHE.mkdir(parents=True, exist_ok=True)
    folder = Path(tempfile.mkdtemp(dir=CACHE))
    try:
        _run("apt-get", "download", *PACKAGES, folder=folder)
        packages = sorted(folder.glob("*.deb"))
        if len(packages) != len(PACKAGES):
            pytest.skip(f"rs274 is not here: {len(packages)} packages came")
        for package in packages:
            _run("dpkg", "-x", str(package), "root", folder=folder)
        try:
            (folder / "root").rename(PLACE)
        except OSError:
            assert PLACE.is_dir()
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def interpreter_in(folder: Path) -> Callable[[bytes], str]:
    """LinuxCNC's interpreter in a folder of its own: NC code in, canonical commands out."""
    if not PLACE.is_dir():
        _fetch()
    (folder / "mill.ini").write_text(SETTINGS)
    (folder / "tool.tbl").write_text(TOOLS)
    libraries = PLACE / "usr" / "lib"
    paths = f"{libraries}:{libraries / f'{platform.machine()}-linux-gnu'}"
    program = PLACE / "usr" / "bin" / "rs274"
    options = ("-g", "-i", "mill.ini", "-t", "tool.tbl", "-v", "rs.var")

    def interpret(data: bytes) -> str:
        (folder / "part.ngc").write_bytes(data)
        (folder / "rs.var").write_text("")
        answer = subprocess.run(
            [str(program), *options, "part.ngc", "out.canon"],
            cwd=folder,
            # It maps its tools in a file under HOME, which workers must not share.
            env={**os.environ, "LD_LIBRARY_PATH": paths, "HOME": str(folder)},
            capture_output=True,
            text=True,
            timeout=120.0,
            check=False,
        )
        if "error while loading shared libraries" in answer.stderr:
            pytest.skip(f"rs274 does not run here: {answer.stderr.strip()}")
        assert answer.returncode == 0, answer.stderr
        return (folder / "out.canon").read_text(errors="replace")

    return interpret


@pytest.fixture(scope="session")
def interpreter(tmp_path_factory: pytest.TempPathFactory) -> Interpreter:
    """LinuxCNC's interpreter: lines of NC code in, canonical commands out."""
    interpret = interpreter_in(tmp_path_factory.mktemp("rs274"))

    def interpret_lines(lines: Iterable[str]) -> tuple[Canonical, ...]:
        text = "".join(f"{line}\n" for line in lines)
        return tuple(read(interpret(text.encode()).splitlines()))

    return interpret_lines


def _head(machine: MachineType, *, name: str = "PART") -> list[Block]:
    return [
        ProgramStart(name=name, machine=machine),
        Comment(text="T1 MILL 10MM"),
        ToolChange(number=1, id="MILL 10MM"),
    ]


@pytest.fixture
def milled() -> list[Block]:
    """Lines, arcs and helices in all planes, dwell, both modes of feed, stops, coolant."""
    return [
        *_head(MachineType.MILL, name="BRACKET (TOP)"),
        Comment(text="POCKET 1 (rough); 50 % ä"),
        SPINDLE,
        Coolant(kinds=frozenset({CoolantKind.FLOOD})),
        Retract(z=50.0),
        Rapid(end=(0.0, 0.0, 50.0)),
        Rapid(end=(0.0, 0.0, 5.0)),
        Linear(end=(0.0, 0.0, -1.0), rate=PER_MINUTE),
        Circular(
            end=(10.0, 10.0, -1.0),
            arc=Arc(centre=(10.0, 0.0, 0.0), turn=-0.5 * pi),
            rate=FASTER,
        ),
        Circular(
            end=(10.0, 10.0, -4.0), arc=Arc(centre=(10.0, 0.0, 0.0), turn=-6 * pi), rate=FASTER
        ),
        Circular(
            end=(20.0, 0.0, -8.0),
            arc=Arc(centre=(10.0, 0.0, 0.0), turn=-4.5 * pi),
            rate=PER_REVOLUTION,
        ),
        Circular(
            end=(20.0, 0.0, -8.0),
            arc=Arc(centre=(10.0, 0.0, 0.0), turn=2 * pi),
            rate=PER_MINUTE,
        ),
        Circular(
            end=(30.0, 0.0, 2.0),
            arc=Arc(centre=(20.0, 0.0, 2.0), turn=-1.5 * pi, plane=ArcPlane.ZX),
            rate=PER_MINUTE,
        ),
        Circular(
            end=(30.0, 10.0, 12.0),
            arc=Arc(centre=(0.0, 10.0, 2.0), turn=1.5 * pi, plane=ArcPlane.YZ),
            rate=PER_MINUTE,
        ),
        Pause(seconds=0.5),
        Linear(end=(30.0, 20.0, 12.0), rate=PER_MINUTE),
        SpindleOn(speed=30.0, sense=SpindleDirection.COUNTERCLOCKWISE),
        Coolant(kinds=frozenset({CoolantKind.MIST})),
        OptionalStopBlock(),
        Linear(end=(31.0, 21.0, 11.0), rate=PER_MINUTE),
        Retract(z=50.0),
        SpindleOrient(),
        ProgramStopBlock(),
        Message(text="turn the part (now)"),
        SpindleOff(),
        Coolant(),
        ToolChange(number=2, id="DRILL"),
        SpindleOn(speed=25.0),
        Retract(z=50.0),
        Rapid(end=(5.0, 5.0, 50.0)),
        Linear(end=(5.0, 5.0, 0.0), rate=PER_MINUTE),
        ProgramEnd(),
    ]


@pytest.fixture
def drilled() -> list[Block]:
    """Every drilling cycle at two places, after an arc in another plane."""
    blocks: list[Block] = [
        *_head(MachineType.MILL),
        SPINDLE,
        Retract(z=30.0),
        Rapid(end=(0.0, 0.0, 30.0)),
        Circular(
            end=(10.0, 0.0, 40.0),
            arc=Arc(centre=(10.0, 0.0, 30.0), turn=0.5 * pi, plane=ArcPlane.ZX),
            rate=PER_MINUTE,
        ),
        Rapid(end=(10.0, 0.0, 10.0)),
    ]
    for kind in CycleKind:
        if kind is CycleKind.TAP:
            continue
        for x in (1.0, 2.5):
            cycle = DrillingCycle(
                kind=kind,
                at=(x, 3.0),
                retract_z=10.0,
                bottom_z=-7.0,
                rate=PER_MINUTE,
                step_depth=4.0 if kind in {CycleKind.PECK, CycleKind.CHIP_BREAK} else 0.0,
                retract_distance=CLEARANCE,
                dwell=0.5 if kind is CycleKind.DWELL else 0.0,
            )
            blocks += [Rapid(end=(x, 3.0, 10.0)), expanded(cycle, SPINDLE)]
    return [*blocks, Retract(z=30.0), SpindleOff(), ProgramEnd()]


@pytest.fixture
def tapped() -> list[Block]:
    """Right-hand and left-hand taps, cut after an arc in another plane."""
    taps = [
        RigidTap(start=(0.0, 0.0, 5.0), bottom_z=-15.0, lead=1.25, speed=5.0),
        RigidTap(
            start=(20.0, 0.0, 5.0),
            bottom_z=-15.5,
            lead=1.75,
            speed=4.0,
            sense=SpindleDirection.COUNTERCLOCKWISE,
        ),
    ]
    blocks: list[Block] = [
        *_head(MachineType.MILL),
        SPINDLE,
        Retract(z=5.0),
        Rapid(end=(0.0, 0.0, 5.0)),
        Circular(
            end=(0.0, 0.0, 5.0),
            arc=Arc(centre=(0.0, 0.0, 10.0), turn=2 * pi, plane=ArcPlane.ZX),
            rate=PER_MINUTE,
        ),
    ]
    for tap in taps:
        blocks += [Rapid(end=tap.start), tap]
    return [*blocks, SPINDLE, Linear(end=(21.0, 0.0, 5.0), rate=PER_MINUTE), ProgramEnd()]


@pytest.fixture
def turned() -> list[Block]:
    """A lathe: constant surface speed with limit, both modes of feed, arcs, threads."""
    back = (15.0, 0.0, 2.0)
    return [
        *_head(MachineType.LATHE, name="SHAFT"),
        Comment(text="ROUGH CONTOUR"),
        SurfaceSpeed(speed=2500.0, limit=50.0),
        Coolant(kinds=frozenset({CoolantKind.FLOOD})),
        Retract(z=10.0),
        Rapid(end=(35.0, 0.0, 10.0)),
        Linear(end=(30.0, 0.0, 0.0), rate=PER_REVOLUTION),
        Circular(
            end=(40.0, 0.0, -10.0),
            arc=Arc(centre=(30.0, 0.0, -10.0), turn=-0.5 * pi, plane=ArcPlane.ZX),
            rate=PER_REVOLUTION,
        ),
        Linear(end=(40.5, 0.0, -20.0), rate=PER_MINUTE),
        SurfaceSpeed(speed=3000.0, limit=60.0),
        Linear(end=(40.5, 0.0, -30.0), rate=PER_REVOLUTION),
        SpindleOff(),
        Coolant(),
        ToolChange(number=2, id="THREAD"),
        SpindleOn(speed=12.5),
        Retract(z=2.0),
        Rapid(end=back),
        ThreadingMove(end=(15.0, 0.0, -20.0), lead=2.0),
        Rapid(end=(20.0, 0.0, -20.0)),
        Rapid(end=back),
        ThreadingMove(end=(16.0, 0.0, -20.0), lead=2.0),
        Linear(end=(20.0, 0.0, -20.0), rate=PER_MINUTE),
        SpindleOff(),
        ProgramEnd(),
    ]


coordinates = st.floats(-200.0, 200.0).map(lambda value: value + 0.0)
points = st.tuples(coordinates, coordinates, coordinates)
rates = st.builds(
    Rate,
    value=st.floats(0.01, 100.0),
    mode=st.sampled_from(RateMode),
)
turns = st.one_of(
    st.floats(0.001, 6.0 * pi), st.sampled_from([0.5 * pi, pi, 2 * pi, 4 * pi, 2 * pi - 1e-5])
)


HEAD: list[Block] = [
    ProgramStart(name="RANDOM"),
    ToolChange(number=1),
    SpindleOn(speed=10.0),
    Retract(z=50.0),
    Rapid(end=(0.0, 0.0, 50.0)),
]


LEAST_HELIX = 0.5
"""mm: an end on the grid turns a smaller helix so far that its single turns end elsewhere"""


@st.composite
def motions(draw: st.DrawFn) -> list[Block]:
    """Lines, rapids, arcs and helices, each from where the last one ended."""
    at: Point = (0.0, 0.0, 50.0)
    blocks: list[Block] = []
    for kind in draw(st.lists(st.sampled_from(["line", "rapid", "arc"]), max_size=8)):
        if kind == "arc":
            plane = draw(st.sampled_from(ArcPlane))
            first, second, normal = plane.axes
            centre = list(draw(points))
            turn = draw(turns) * draw(st.sampled_from([-1.0, 1.0]))
            u, v = at[first] - centre[first], at[second] - centre[second]
            size, angle = hypot(u, v), atan2(v, u) + turn
            if size < LEAST_RADIUS:
                continue
            end = list(at)
            end[first] = centre[first] + size * cos(angle)
            end[second] = centre[second] + size * sin(angle)
            # Klartext has no helix outside XY.
            if plane is ArcPlane.XY and size >= LEAST_HELIX:
                end[normal] += draw(st.sampled_from([0.0, 3.21]))
            at = (end[0], end[1], end[2])
            blocks.append(
                Circular(
                    end=at,
                    arc=Arc(centre=(centre[0], centre[1], centre[2]), turn=turn, plane=plane),
                    rate=draw(rates),
                )
            )
        else:
            at = draw(points)
            is_line = kind == "line"
            blocks.append(Linear(end=at, rate=draw(rates)) if is_line else Rapid(end=at))
    return [*HEAD, *blocks, ProgramEnd()]


@pytest.fixture
def moving() -> st.SearchStrategy[list[Block]]:
    """Programs of whatever moves."""
    return motions()
