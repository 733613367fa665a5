"""Runs NC code on LinuxCNC's own interpreter and planner, and records each servo period.

LinuxCNC runs in namespaces of its own, without a screen, root or a realtime kernel, so that
several run at once and nothing is left of one, however it ends. The servo thread may run faster
than the clock; task and dwells do not. Units mm, s, rev/s.
"""

import json
import re
import shutil
import subprocess
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from extras.linuxcnc.configuration import SOCKET, write_configuration, write_loop
from simulator.errors import SimulationError
from simulator.motion.segments import Floats, Ints
from simulator.planner_settings import PlannerSettings
from simulator.spec import Machine
from stepnc_model.toolpath.path import Point

SYSTEM_PYTHON = "/usr/bin/python3"
"""For which Debian builds LinuxCNC's modules."""

NAMESPACES = (
    "unshare", "--user", "--map-user=1000", "--map-group=1000", "--keep-caps", "--ipc", "--pid",
    "--net", "--mount", "--fork", "--kill-child", "--mount-proc",
)  # fmt: skip
"""Not root within: rtapi_app refuses to run as root without a realtime kernel."""

PATIENCE = 600.0
"""Longest time that a program may take by the clock, s."""

FASTER = 20.0
"""Speed-up at which a servo thread on a shared host still kept up, times."""


class LinuxCncFailed(SimulationError):
    """LinuxCNC did not start, or a program did not end."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RecordedMotion:
    """State at N successive servo periods; the first row is at the start of the program."""

    period: float
    """Servo period, s."""
    position: Floats
    """Commanded position in the program's coordinates, (N, 3), mm; on a lathe X is a radius."""
    spindle: Floats
    """Spindle speed, (N,), rev/s."""
    speed: Floats
    """Speed along the path, (N,), mm/s."""
    line: Ints
    """Line of the program that moves, counted from 1, (N,); the last one during a wait."""
    kind: Ints
    """Kind of motion, (N,): 0 none, 1 rapid, 2 feed, 3 arc, 4 tool change."""

    def __len__(self) -> int:
        return len(self.line)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ProgramRun:
    """What LinuxCNC did with one program."""

    messages: tuple[str, ...]
    """Messages to the operator, errors among them."""
    motion: RecordedMotion

    @property
    def last_line(self) -> int:
        """Last line that moved the axes; 0 if none did.

        Compared with the last line of the program that has a move, it tells a program that
        ended early, which LinuxCNC does not always say.
        """
        moved = np.flatnonzero(self.motion.line)
        return int(self.motion.line[moved[-1]]) if len(moved) else 0

    @property
    def end(self) -> Floats:
        """Place where the program ended, (3,), mm."""
        place: Floats = self.motion.position[-1]
        return place


def reason_why_not() -> str:
    """Reason why LinuxCNC cannot run here; empty if it can."""
    programs = ("linuxcncsvr", "milltask", "halcmd", "halsampler")
    if any(shutil.which(name) is None for name in programs):
        return "no LinuxCNC: apt-get install --no-install-recommends linuxcnc-uspace"
    if shutil.which("gcc") is None:
        return "no C compiler to run LinuxCNC faster than the clock: apt-get install gcc"
    trial = subprocess.run([*NAMESPACES, "true"], capture_output=True, text=True, check=False)
    return f"no namespaces for LinuxCNC: {trial.stderr.strip()}" if trial.returncode else ""


def run_programs(
    machine: Machine,
    programs: Sequence[Path],
    *,
    settings: PlannerSettings | None = None,
    starts: Sequence[Point | None] = (),
    speedup: float = FASTER,
    patience: float = PATIENCE,
) -> list[ProgramRun]:
    """Run programs one after another on a LinuxCNC that is started for them.

    Parameters
    ----------
    machine : Machine
    programs : sequence of Path
        NC code for LinuxCNC.
    settings : PlannerSettings, optional
        Settings of the INI file; by default the machine's.
    starts : sequence of 3 floats or None, mm
        Places from which the programs start; by default where the one before ended.
    speedup : float
        Speed of the servo thread, times the clock.
    patience : float, s
        Longest time by the clock that a program may take.

    Returns
    -------
    list of ProgramRun

    Raises
    ------
    LinuxCncFailed
        If LinuxCNC does not start, a program does not end, or samples were lost.
    """
    settings = settings or PlannerSettings()
    # The name of a fifo may have 107 characters at most.
    with tempfile.TemporaryDirectory(prefix="stepnc-lcnc-", dir="/tmp") as name:
        folder = Path(name)
        tools = {number for path in programs for number in _tools(path)}
        write_configuration(folder, machine, settings, tools=tools)
        orders: list[dict[str, Any]] = [
            {
                "file": str(path.resolve()),
                "samples": str(folder / f"samples-{row}"),
                "start": _way_to(starts[row] if starts else None, machine),
                "waits_for_loop": False,
            }
            for row, path in enumerate(programs)
        ]
        order = {
            "folder": name,
            "preload": _preload(folder) if speedup != 1.0 else "",
            "speedup": speedup,
            "patience_s": patience,
            "programs": orders,
            "loop": False,
        }
        (folder / "order.json").write_text(json.dumps(order), "utf-8")
        ended = _session(folder)
        if len(ended) < len(programs) or any("failed" in each for each in ended):
            raise LinuxCncFailed(_why(folder, ended))
        return [
            _program_run(each, Path(told["samples"]), settings.servo_period)
            for each, told in zip(ended, orders, strict=True)
        ]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LoopBench:
    """LinuxCNC with the component of the loop, which runs one program once a loop is armed."""

    socket: Path
    """Where the component listens."""
    folder: Path
    session: subprocess.Popen[bytes]
    period: float
    """Servo period, s."""
    told: list[dict[str, Any]] = field(default_factory=list)
    """What the session said of the program, once it has ended."""

    def order(self, *words: str | float) -> str:
        """Do what an operator does, or a fault; return the answer.

        Parameters
        ----------
        *words : str or float
            ``halcmd`` and its words, ``kill`` and a part of a command line, or a method of
            LinuxCNC's command channel with its values.

        Raises
        ------
        LinuxCncFailed
            If LinuxCNC has ended.
        """
        assert self.session.stdin is not None
        assert self.session.stdout is not None
        try:
            self.session.stdin.write(json.dumps(words).encode() + b"\n")
            self.session.stdin.flush()
        except BrokenPipeError as error:
            raise LinuxCncFailed(_why(self.folder, [])) from error
        for line in self.session.stdout:
            told = json.loads(line)
            if "answer" in told:
                return str(told["answer"])
            self.told.append(told)
        raise LinuxCncFailed(_why(self.folder, self.told))

    def ended(self) -> ProgramRun:
        """Wait for the end of the program; return its run.

        Raises
        ------
        LinuxCncFailed
            If the program does not end, or samples were lost.
        """
        assert self.session.stdout is not None
        if not self.told:
            line = self.session.stdout.readline()
            self.told.append(json.loads(line) if line else {"failed": "it ended early"})
        told = self.told[0]
        if "failed" in told:
            raise LinuxCncFailed(_why(self.folder, [told]))
        return _program_run(told, self.folder / "samples", self.period)


@contextmanager
def bench_with_loop(
    machine: Machine,
    program: Path,
    *,
    start: Point | None = None,
    load_limit: float,
    patience: float = PATIENCE,
) -> Iterator[LoopBench]:
    """Start LinuxCNC with the component of the loop, in real time; end it afterwards.

    Parameters
    ----------
    machine : Machine
    program : Path
        NC code for LinuxCNC, which begins once the component is armed.
    start : 3 floats, mm, optional
    load_limit : float
        Load above which realtime holds the feed, in the unit of the load.
    patience : float, s

    Raises
    ------
    LinuxCncFailed
        If LinuxCNC does not start.
    """
    settings = machine.planner
    with tempfile.TemporaryDirectory(prefix="stepnc-lcnc-", dir="/tmp") as name:
        folder = Path(name)
        write_configuration(folder, machine, settings, tools=_tools(program))
        write_loop(folder, load_limit=load_limit)
        order = {
            "folder": name,
            "preload": "",
            "speedup": 1.0,
            "patience_s": patience,
            "loop": True,
            "programs": [
                {
                    "file": str(program.resolve()),
                    "samples": str(folder / "samples"),
                    "start": _way_to(start, machine),
                    "waits_for_loop": True,
                }
            ],
        }
        (folder / "order.json").write_text(json.dumps(order), "utf-8")
        with _started(folder) as session:
            assert session.stdout is not None
            if not session.stdout.readline():
                raise LinuxCncFailed(_why(folder, []))
            yield LoopBench(
                socket=folder / SOCKET,
                folder=folder,
                session=session,
                period=settings.servo_period,
            )


def _tools(program: Path) -> Iterable[int]:
    """Numbers of the tools that a program calls."""
    code = re.sub(r"\([^)]*\)|;.*", "", program.read_text("utf-8", "replace"))
    return (int(number) for number in re.findall(r"[Tt]\s*(\d+)", code))


def _way_to(start: Point | None, machine: Machine) -> list[str]:
    """Commands that lead to the start of a program, X as a radius."""
    if start is None:
        return []
    places = zip("XYZ", start, strict=True)
    axes = {axis.name for axis in machine.axes}
    words = " ".join(f"{name}{place:.6f}" for name, place in places if name in axes)
    return ["G8 G21 G49 G54 G90 G94", f"G0 {words}"]


def _preload(folder: Path) -> str:
    """Compile the library that runs the servo thread faster."""
    source, library = Path(__file__).with_name("speedup.c"), folder / "speedup.so"
    subprocess.run(
        ["gcc", "-shared", "-fPIC", "-O2", "-o", library, source, "-ldl"],
        check=True,
        capture_output=True,
    )
    return str(library)


def _session(folder: Path) -> list[dict[str, Any]]:
    """Run the session; return what it said of each program."""
    with _started(folder) as session:
        assert session.stdout is not None
        return [json.loads(line) for line in session.stdout]


@contextmanager
def _started(folder: Path) -> Iterator[subprocess.Popen[bytes]]:
    """Session as a process, which ends with the block."""
    script = Path(__file__).with_name("session.py")
    # Its standard input stays open as long as this process lives.
    with (folder / "session.log").open("wb") as log:
        session = subprocess.Popen(
            [*NAMESPACES, SYSTEM_PYTHON, "-I", script, folder / "order.json"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=log,
        )
        try:
            yield session
        finally:
            # unshare ignores SIGTERM; all of its children end with it.
            session.kill()
            session.communicate()


def _why(folder: Path, ended: Sequence[dict[str, Any]]) -> str:
    """What failed, with the end of the logs."""
    told = next((each["failed"] for each in ended if "failed" in each), "it ended early")
    logs = [folder / "start.log", folder / "session.log"]
    tail = [
        line
        for log in logs
        if log.exists()
        for line in log.read_text("utf-8", "replace").splitlines()[-3:]
    ]
    return f"LinuxCNC: {told}; " + " | ".join(tail)


def _program_run(told: dict[str, Any], samples: Path, period: float) -> ProgramRun:
    """Read the samples of a program."""
    if told["lost"]:
        raise LinuxCncFailed(f"LinuxCNC: {told['lost']} samples were lost")
    with samples.open() as lines:
        # Samples count on from one program to the next, which a new reader calls an overrun.
        first = next(lines, "")
        begin = () if "overrun" in first else (first,)
        rows = np.loadtxt(chain(begin, lines), comments=None, ndmin=2).reshape(-1, 8)
    if (np.diff(rows[:, 0]) != 1.0).any():
        raise LinuxCncFailed("LinuxCNC: samples are missing")
    return ProgramRun(
        messages=tuple(told["messages"]),
        motion=RecordedMotion(
            period=period,
            position=rows[:, 1:4],
            spindle=rows[:, 4],
            speed=rows[:, 5],
            line=rows[:, 6].astype(np.int64),
            kind=rows[:, 7].astype(np.int64),
        ),
    )
