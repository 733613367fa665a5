"""What LinuxCNC does with the programs that we post, beside the models of its motion.

Each sample part is posted, run by a real LinuxCNC to its end, and run again in other path
modes. The models plan the same code. Times are of moving axes: waits for the spindle are no
matter of motion. Deviations are those of feed moves: of the control and of the model from the
programmed path, and of the control from the path of the model. Two further tables have the
closed loop in real time: its laws under hidden steps, and its faults.
"""

import argparse
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import cos, pi, sin
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from scipy.spatial import KDTree

import stepnc
from benchmarks.linuxcnc_faults import print_ends
from benchmarks.linuxcnc_loop import print_runs
from extras.linuxcnc.bench import (
    FASTER,
    LinuxCncFailed,
    ProgramRun,
    RecordedMotion,
    reason_why_not,
    run_programs,
)
from simulator.library import load_machine
from simulator.machine.interpreter import interpret
from simulator.machine.samples import Episode
from simulator.machine.virtual import MachineSetup, VirtualMachine
from simulator.motion.control import control_model
from simulator.motion.linuxcnc_planner import PlannedMotion
from simulator.motion.model_name import ControlModelName
from simulator.motion.segments import Floats, Kinematics, Motion, Segments, axis_limits
from simulator.spec import Machine, MachineKind
from stepnc_model.nc.exact_reading import ZERO, read_exactly
from stepnc_model.nc.neutral_blocks import stream_blocks
from stepnc_model.post.blocks import Block, MachineType
from stepnc_model.post.dialect import Dialect
from stepnc_model.toolpath.path import Point

PARTS = {
    "paper000": "vmc15",
    "paper002": "vmc15",
    "paper003_case1": "vmc15",
    "paper003_case2": "vmc15",
    "paper003_pocket": "vmc15",
    "bracket": "vmc15",
    "shaft": "lathe22",
}
"""Sample parts, with the machine that makes them."""

MODES = {
    "posted": "",
    "P0.01": "G64 P0.01",
    "P0.01 Q0": "G64 P0.01 Q0",
    "G64": "G64",
    "G61": "G61",
    "G61.1": "G61.1",
}
"""Path modes: as posted, or a word that replaces each of those that were posted."""

EXAMPLES = Path(__file__).parents[1] / "examples" / "parts"
SPACING = 0.01
"""Greatest distance of points on paths that are compared, mm: chords of arcs are exact."""
PLACE = 0.002
"""Distance from the end of a program that counts as its place, mm."""
NEIGHBOURS = 8
"""Points of a path near which the nearest place is searched."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StepTimes:
    """Moving times of one workingstep, s."""

    name: str
    control: float
    model: float

    @property
    def error(self) -> float:
        """Difference of the model from the control, s."""
        return self.model - self.control

    @property
    def is_met(self) -> bool:
        """True within 1 % or 15 ms."""
        return abs(self.error) <= max(0.01 * self.control, 0.015)


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """One program on the control, and as the models have it."""

    name: str
    run: ProgramRun
    last_line: int
    """Last line of the program with a move."""
    end: Point
    """Place where the program ends, mm."""
    control_time: float
    """Moving time of the control, s."""
    model_times: dict[ControlModelName, float]
    """Moving times of the models, s."""
    steps: tuple[StepTimes, ...]
    """Workingsteps by the model of LinuxCNC."""
    control_deviation: float
    """Greatest distance of the control from the programmed path on feed moves, mm."""
    model_deviation: float
    """Greatest distance of the model from the programmed path, mm."""
    apart: float
    """Greatest distance of the control from the path of the model, mm."""

    @property
    def is_complete(self) -> bool:
        """True if the program ended at its last line and place, without a message."""
        is_there = np.allclose(self.run.end, self.end, atol=PLACE)
        return bool(not self.run.messages and self.run.last_line == self.last_line and is_there)

    def ratio(self, model: ControlModelName) -> float:
        """Time of a model over that of the control."""
        return self.model_times[model] / self.control_time


def compared(
    machine: Machine, programs: Sequence[Path], *, speedup: float = FASTER
) -> Iterator[Comparison]:
    """Run programs on the control, and compare each with the models.

    Parameters
    ----------
    machine : Machine
    programs : sequence of Path
        NC code as ``stepnc post --control linuxcnc`` writes it.
    speedup : float
        Speed of the servo thread, times the clock. LinuxCNC reads one block in each millisecond
        by the clock, so that programs of short blocks need 1.
    """
    for path in programs:
        planned = episodes(path, machine, ControlModelName.LINUXCNC)
        start = _point(planned[0].position)
        run = _recorded(machine, path, start, speedup=speedup)
        yield _comparison(path, machine, planned, run)


def _recorded(machine: Machine, path: Path, start: Point, *, speedup: float) -> ProgramRun:
    """Run of a program, slower where a busy machine loses samples of a fast one."""
    while True:
        try:
            (run,) = run_programs(machine, [path], starts=[start], speedup=speedup)
        except LinuxCncFailed as error:
            if "samples were lost" not in str(error) or speedup <= 1.0:
                raise
            speedup = max(0.25 * speedup, 1.0)
        else:
            return run


def episodes(path: Path, machine: Machine, model: ControlModelName) -> list[Episode]:
    """Stretches of motion of a program, as a model of the control has them."""
    control = control_model(model, axis_limits(machine), planner=machine.planner)
    virtual = VirtualMachine(MachineSetup(machine=machine, control=control))
    run = virtual.run(interpret(_numbered(path, machine), machine))
    return [episode for episode in run if episode.course is not None]


def _numbered(path: Path, machine: Machine) -> Iterator[tuple[int, Block]]:
    """Blocks of a program with their lines."""
    kind = MachineType.MILL if machine.kind is MachineKind.MILL else MachineType.LATHE
    program = read_exactly(path.read_bytes(), Dialect.LINUXCNC, machine=kind)
    yield from stream_blocks(program, at=ZERO)


def _comparison(
    path: Path, machine: Machine, planned: Sequence[Episode], run: ProgramRun
) -> Comparison:
    times = {
        name: float(
            _line_times(
                planned if name is ControlModelName.LINUXCNC else episodes(path, machine, name)
            ).sum()
        )
        for name in ControlModelName
    }
    motion = run.motion
    is_moving = motion.speed > 0.0
    fed = motion.position[is_moving & ((motion.kind == 2) | (motion.kind == 3))]
    programmed = [_points_of_segments(episode) for episode in planned]
    states = [_states_of_motion(episode) for episode in planned]
    modelled = [state.position for state in states]
    model_fed = [
        state.position[~_segments(episode).is_rapid[state.segment]]
        for state, episode in zip(states, planned, strict=True)
    ]
    last = _segments(planned[-1])
    return Comparison(
        name=path.stem,
        run=run,
        last_line=int(last.block[-1]),
        end=_point(last.end[-1]),
        control_time=float(is_moving.sum()) * motion.period,
        model_times=times,
        steps=tuple(_steps(path, motion, planned)),
        control_deviation=_farthest(fed, programmed),
        model_deviation=_farthest(np.concatenate(model_fed), programmed),
        apart=_farthest(fed, modelled),
    )


def _segments(episode: Episode) -> Segments:
    assert episode.course is not None
    return episode.course.segments


def _point(place: Floats) -> Point:
    x, y, z = place.tolist()
    return x, y, z


def _line_times(planned: Sequence[Episode]) -> Floats:
    """Moving times of a model by line, s."""
    lines, seconds = [], []
    for episode in planned:
        assert episode.course is not None
        motion = episode.course.motion
        times = np.diff(motion.ends, prepend=0.0)
        for row, rest in _rests(motion):
            times[row] -= rest
        lines.append(episode.course.segments.block)
        seconds.append(times)
    found = np.bincount(np.concatenate(lines), weights=np.concatenate(seconds))
    return found.astype(np.float64)


def _rests(motion: Motion) -> Iterator[tuple[int, float]]:
    """Segments of the model of LinuxCNC after which it rests for a part of a servo period."""
    if not isinstance(motion, PlannedMotion):
        return
    profile = motion.profile
    for phase in np.flatnonzero((profile.speed == 0.0) & (profile.acceleration == 0.0)):
        row = int(np.searchsorted(motion.ends, profile.start[phase] - 1e-9))
        yield min(row, len(motion.ends) - 1), float(profile.time[phase])


def _steps(
    path: Path, motion: RecordedMotion, planned: Sequence[Episode]
) -> Iterator[StepTimes]:
    """Times of the workingsteps, which begin where a comment stands before a path mode."""
    text = path.read_text("ascii").splitlines()
    begins = [
        row + 1
        for row, (line, after) in enumerate(pairwise(text))
        if line.startswith("(") and not after.startswith("(") and row > 1
    ]
    real = np.bincount(motion.line[motion.speed > 0.0], minlength=len(text) + 1)
    model = _line_times(planned)
    for first, end in pairwise([*begins, len(text) + 1]):
        if control := float(real[first:end].sum()) * motion.period:
            yield StepTimes(
                name=text[first - 1].strip("()"),
                control=control,
                model=float(model[first:end].sum()),
            )


def _points_of_segments(episode: Episode) -> Floats:
    """Points of the programmed path, (N, 3), mm."""
    segments = _segments(episode)
    parts = [segments.start[:1]]
    for row in range(len(segments)):
        count = int(segments.length[row] / SPACING) + 1
        station = float(segments.length[row]) * np.arange(1, count + 1) / count
        parts.append(segments.position(np.full(count, row), station))
    return np.concatenate(parts)


def _states_of_motion(episode: Episode) -> Kinematics:
    """States of the model, close to each other."""
    assert episode.course is not None
    motion = episode.course.motion
    ends = np.union1d(motion.knots, motion.ends)
    fastest = np.linalg.norm(motion.at(ends).velocity, axis=1)
    count = np.maximum(fastest[1:], fastest[:-1]) * np.diff(ends) / SPACING + 1.0
    times = [
        np.linspace(begin, end, int(parts), endpoint=False)
        for begin, end, parts in zip(ends[:-1], ends[1:], count, strict=True)
    ]
    return motion.at(np.append(np.concatenate(times), ends[-1]))


def _farthest(points: Floats, paths: Sequence[Floats]) -> float:
    """Greatest distance of points from the nearest of some polylines, mm."""
    starts = np.concatenate([path[:-1] for path in paths])
    ways = np.concatenate([np.diff(path, axis=0) for path in paths])
    _, near = KDTree(starts).query(points, k=min(NEIGHBOURS, len(starts)))
    found = np.full(len(points), np.inf)
    size = np.maximum(np.sum(ways**2, axis=1), 1e-30)
    for column in np.atleast_2d(near.T):
        for row in (np.maximum(column - 1, 0), column):
            beside = points - starts[row]
            part = np.clip(np.sum(beside * ways[row], axis=1) / size[row], 0.0, 1.0)
            distance = np.linalg.norm(beside - part[:, None] * ways[row], axis=1)
            found = np.minimum(found, distance)
    return float(found.max(initial=0.0))


def posted(part: str, mode: str, folder: Path) -> Path:
    """Post a sample part in a path mode."""
    path = folder / f"{part} {mode}.ngc"
    stepnc.post(str(EXAMPLES / f"{part}.stpnc"), control="linuxcnc", output=str(path))
    if MODES[mode]:
        text = re.sub(r"G6[14][^\n]*", MODES[mode], path.read_text("ascii"))
        path.write_text(text, "ascii")
    return path


HEAD = "G17 G21 G40 G49 G54 G80 G90 G91.1 G94"


def experiments(folder: Path) -> list[Path]:
    """Small programs in which the planner's rules matter most."""
    programs = {}
    for feed in (600, 3000, 6000, 12000):
        corners = f"{HEAD}\nG64 P0.01\nG0 X0 Y0 Z0\nG1 X20 F{feed}\nY20\nX0 Y40\nX20 Y38\n"
        programs[f"corners F{feed}"] = corners
    for size in (0.05, 0.25, 1.0):
        for tolerance in (0.01, 0.05):
            count = round(2.0 * pi * 10.0 / size)
            angles = [2.0 * pi * row / count for row in range(1, count + 1)]
            lines = [f"X{10 * cos(a):.4f} Y{10 * sin(a):.4f}" for a in angles]
            text = f"{HEAD}\nG64 P{tolerance}\nG0 X10 Y0 Z0\nG1 F6000 " + "\n".join(lines)
            programs[f"circle {size} P{tolerance}"] = text
    turns = [2.0 * pi * row / 200.0 for row in range(2001)]
    spiral = [
        f"X{(30 - 2.5 * a / 2 / pi) * cos(a):.4f} Y{(30 - 2.5 * a / 2 / pi) * sin(a):.4f} "
        f"Z{-0.5 * a / 2 / pi:.4f}"
        for a in turns
    ]
    programs["spiral P0.01"] = f"{HEAD}\nG64 P0.01\nG0 {spiral[0]}\nG1 F2540 " + "\n".join(
        spiral[1:]
    )
    paths = []
    for name, text in programs.items():
        paths.append(folder / f"{name}.ngc")
        paths[-1].write_text(f"{text}\nM2\n", "ascii")
    return paths


def table(found: Comparison) -> str:
    """Row of the table."""
    others = " ".join(f"{100 * found.ratio(name) - 100:+10.2f}" for name in ControlModelName)
    worst = max(found.steps, key=lambda step: abs(step.error), default=None)
    step = "" if worst is None else f"{1000 * worst.error:+5.0f} ms of {worst.control:.1f} s"
    return (
        f"{found.name:24}{'yes' if found.is_complete else 'NO':>5}{found.control_time:10.3f} "
        f"{others}  {step:22}{1000 * found.control_deviation:8.1f}"
        f"{1000 * found.model_deviation:8.1f}{1000 * found.apart:8.1f}"
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--parts", default=",".join(PARTS), help="sample parts")
    parser.add_argument("--modes", default="posted,G61", help=", ".join(MODES))
    parser.add_argument("--without-experiments", action="store_true")
    parser.add_argument("--only", choices=("motion", "loop", "faults"), help="one table")
    options = parser.parse_args(arguments)
    if reason := reason_why_not():
        print(f"not run: {reason}")
        return
    if options.only in {None, "motion"}:
        _print_motion(options)
    if options.only in {None, "loop"}:
        print_runs()
    if options.only in {None, "faults"}:
        print_ends()


def _print_motion(options: argparse.Namespace) -> None:
    """Print the table of motion."""
    names = " ".join(f"{name.value:>10}" for name in ControlModelName)
    print(f"{'':24}{'':5}{'moving':>10}  models, % more than the control", end="")
    print(f"{'':13}worst workingstep     µm from path   and from")
    print(f"{'program':24}{'ends':>5}{'s':>10} {names}  ", end="")
    print(f"{'by linuxcnc':22} control   model each other")
    with TemporaryDirectory() as name:
        folder = Path(name)
        for part in filter(None, options.parts.split(",")):
            machine = load_machine(PARTS[part])
            paths = [posted(part, mode, folder) for mode in options.modes.split(",")]
            for found in compared(machine, paths):
                print(table(found), flush=True)
        if not options.without_experiments:
            for found in compared(load_machine("vmc15"), experiments(folder), speedup=1.0):
                print(table(found), flush=True)


if __name__ == "__main__":
    main()
