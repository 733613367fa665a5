"""Verification of logged positions: injected errors found, and the speed for long logs.

The bracket runs on vmc15 with exact stop, at 100 Hz with feeds of at most 250 mm/min, and at
10 Hz with all feeds at 1000 mm/min. Errors are put into the positions, as the scales would log
them. ``python -m benchmarks.verification --positions 1000000``
"""

import argparse
import tempfile
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pyarrow as pa
from pyarrow import parquet

from extras.verification.facts import DeviationSpot, surface_deviations
from extras.verification.model.sweep import FAR
from extras.verification.preparation import PreparedProgram, prepared
from extras.verification.requests import VerificationRequest
from extras.verification.run import Verification, verified
from simulator.motion.control import control_model
from simulator.motion.model_name import ControlModelName
from simulator.motion.segments import Bools, Floats, Ints, axis_limits
from simulator.removal.cutter import Cutter, Insert

BRACKET = Path(__file__).parents[1] / "examples" / "parts" / "bracket.stpnc"
SHAFT = BRACKET.with_name("shaft.stpnc")
SHAFT_REQUEST = VerificationRequest(machine="lathe22")
REQUEST = VerificationRequest(machine="vmc15")
SLOW, FAST = 250.0 / 60.0, 1000.0 / 60.0
"""Feeds of the two logs, mm/s."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RunLog:
    """N positions of a run."""

    time: Floats
    position: Floats
    """(N, 3), mm"""
    tool: Ints
    workingstep: Ints
    block: Ints

    def within(self, program: PreparedProgram, workingstep: str) -> Bools:
        """True if a position is of a workingstep, (N,)."""
        names = [each.workingstep for each in program.steps]
        return np.asarray(self.workingstep == names.index(workingstep))

    def only(self, rows: Bools) -> "RunLog":
        """Some of the positions."""
        return RunLog(
            time=self.time[rows], position=self.position[rows], tool=self.tool[rows],
            workingstep=self.workingstep[rows], block=self.block[rows],
        )  # fmt: skip

    def write(self, path: Path, program: PreparedProgram) -> Path:
        """Write the log as Parquet."""
        names = [each.workingstep for each in program.steps]
        columns = {"time_s": self.time}
        columns |= {
            f"{axis}_axis_position_actual": self.position[:, row]
            for row, axis in enumerate("xyz")
        }
        words = pa.DictionaryArray.from_arrays(pa.array(self.workingstep), pa.array(names))
        table = pa.table({**columns, "tool_number": self.tool, "workingstep": words})
        parquet.write_table(table, path)
        return path


def run_log(
    program: PreparedProgram, *, rate: float, feed: Callable[[Floats], Floats]
) -> RunLog:
    """Log a run of a program without errors.

    Parameters
    ----------
    program : PreparedProgram
    rate : float, Hz
    feed : callable
        Function from programmed feeds to those of the run, mm/s.
    """
    control = control_model(
        ControlModelName.EXACT_STOP, axis_limits(program.machine), deviation=0.01
    )
    begin, parts = 0.0, []
    for run in program.path.runs:
        is_rapid = run.segments.is_rapid
        speed = np.where(is_rapid, run.segments.speed, feed(run.segments.speed))
        motion = control.plan(replace(run.segments, speed=speed), axis_limits(program.machine))
        first = np.ceil(begin * rate)
        times = np.arange(first, (begin + motion.duration) * rate) / rate
        at = motion.at(np.clip(times - begin, 0.0, motion.duration))
        count = len(times)
        parts.append((
            times, at.position, np.full(count, run.tool), np.full(count, run.workingstep),
            run.segments.block[at.segment],
        ))  # fmt: skip
        begin += motion.duration
    time_, position, tool, step, block = (
        np.concatenate(each) for each in zip(*parts, strict=True)
    )
    return RunLog(time=time_, position=position, tool=tool, workingstep=step, block=block)


@dataclass(frozen=True, slots=True, kw_only=True)
class InjectedError:
    """Error that is put into a log."""

    name: str
    size: float
    """mm; 0: nothing may be found"""
    workingstep: str
    """Surface on which it must be found."""
    make: Callable[[RunLog, PreparedProgram], RunLog]
    tool: int = 0
    """Tool whose radius is measured larger; 0: none."""
    radius: float = 0.0
    """Amount by which its radius, or that of its nose, is larger, mm."""
    is_growing: bool = False
    """Whether the error grows from 0 to its size over the log."""


def offset(size: float, workingstep: str = "FINISH POCKET", *, axis: int = 0) -> InjectedError:
    """One workingstep moved along an axis, X by default."""

    def make(log: RunLog, program: PreparedProgram) -> RunLog:
        position = log.position.copy()
        position[log.within(program, workingstep), axis] += size
        return replace(log, position=position)

    return InjectedError(
        name=f"offset of {workingstep} in {'XYZ'[axis]}",
        size=size,
        workingstep=workingstep,
        make=make,
    )


def skipped_pass(workingstep: str, size: float, *, axis: int, below: float) -> InjectedError:
    """The longest cut of a workingstep is lifted by 20 mm.

    Parameters
    ----------
    workingstep : str
    size : float, mm
        Material that it leaves; at most what is measured.
    axis : int
        Axis along which the tool is lifted.
    below : float, mm
        Greatest coordinate of cuts along this axis.
    """

    def make(log: RunLog, program: PreparedProgram) -> RunLog:
        rows = log.within(program, workingstep) & (log.position[:, axis] < below)
        blocks, counts = np.unique(log.block[rows], return_counts=True)
        position = log.position.copy()
        position[rows & (log.block == blocks[counts.argmax()]), axis] += 20.0
        return replace(log, position=position)

    return InjectedError(name="skipped pass", size=size, workingstep=workingstep, make=make)


def backlash(workingstep: str, sign: float) -> InjectedError:
    """X stays behind by 0.02 mm wherever it moves up (1) or down (-1)."""

    def make(log: RunLog, _: PreparedProgram) -> RunLog:
        step = np.sign(np.diff(log.position[:, 0], prepend=log.position[0, 0]))
        moved = np.maximum.accumulate(np.where(step != 0.0, np.arange(len(step)), 0))
        position = log.position.copy()
        position[:, 0] -= np.where(step[moved] == sign, sign * 0.02, 0.0)
        return replace(log, position=position)

    return InjectedError(name="backlash of X", size=0.02, workingstep=workingstep, make=make)


def drift(log: RunLog, _: PreparedProgram) -> RunLog:
    """Let X grow by 0.05 mm over the run."""
    position = log.position.copy()
    position[:, 0] += 0.05 * log.time / log.time[-1]
    return replace(log, position=position)


def lost_second(workingstep: str, *, axis: int, below: float) -> InjectedError:
    """A second is lost in which the tool goes around a corner, in the middle of a workingstep.

    Parameters
    ----------
    workingstep : str
    axis : int
    below : float, mm
        Greatest coordinate of cuts along this axis.
    """

    def make(log: RunLog, program: PreparedProgram) -> RunLog:
        rows = np.flatnonzero(log.within(program, workingstep))
        low = rows[log.position[rows, axis] < below]
        turns = np.flatnonzero(np.diff(log.block[low]) != 0)
        middle = log.time[low[turns[len(turns) // 2]]]
        return log.only(np.abs(log.time - middle) > 0.5)

    return InjectedError(name="lost second", size=0.0, workingstep="", make=make)


def jittered(log: RunLog, _: PreparedProgram) -> RunLog:
    """Stamps are off by up to 0.4 of the interval, and 5 % of the samples are missing."""
    random = np.random.default_rng(4)
    interval = float(np.median(np.diff(log.time)))
    time_ = log.time + interval * random.uniform(-0.4, 0.4, len(log.time))
    return replace(log, time=time_).only(random.uniform(size=len(log.time)) > 0.05)


def clean(log: RunLog, _: PreparedProgram) -> RunLog:
    """Leave the log as it is."""
    return log


CLEAN = InjectedError(name="none", size=0.0, workingstep="", make=clean)
JITTER = InjectedError(
    name="none; jitter, 5 % missing", size=0.0, workingstep="", make=jittered
)
OFFSETS = (offset(0.3), offset(0.15), offset(0.0254))
TURNED_OFFSETS = tuple(offset(size, "FINISH CONTOUR") for size in (0.3, 0.15, 0.0254))
ERRORS = (
    CLEAN,
    JITTER,
    *OFFSETS,
    offset(0.0254, "FINISH CONTOUR"),
    skipped_pass("MILL STEP", FAR, axis=2, below=-7.9),
    backlash("FINISH POCKET", -1.0),
    InjectedError(
        name="drift of X to 0.05", size=0.05, workingstep="FINISH POCKET", make=drift,
        is_growing=True,
    ),
    InjectedError(
        name="radius of T4", size=0.05, workingstep="FINISH POCKET", make=clean, tool=4,
        radius=0.05,
    ),
    lost_second("FINISH OPEN POCKET", axis=2, below=-9.9),
)  # fmt: skip

ALLOWANCE = 0.5
"""Material that roughing leaves on the contour of the shaft, mm."""

SHAFT_ERRORS = (
    CLEAN,
    JITTER,
    *TURNED_OFFSETS,
    offset(0.0254, "FINISH FACE", axis=2),
    offset(0.15, "THREAD RELIEF"),
    offset(0.0254, "THREAD RELIEF"),
    skipped_pass("FINISH CONTOUR", ALLOWANCE, axis=0, below=26.9),
    backlash("FINISH CONTOUR", 1.0),
    InjectedError(
        name="drift of X to 0.05", size=0.05, workingstep="FINISH CONTOUR", make=drift,
        is_growing=True,
    ),
    InjectedError(
        # At 45° the surface lies before the tip by the radius of the nose times √2 - 1.
        name="nose radius of T2 by 0.05", size=0.05 * (2.0**0.5 - 1.0),
        workingstep="FINISH CONTOUR", make=clean, tool=2, radius=0.05,
    ),
    lost_second("FINISH CONTOUR", axis=0, below=26.9),
)  # fmt: skip

SHORT_OFFSETS = (
    offset(0.15, "THREAD RELIEF"),
    offset(-0.15, "THREAD RELIEF"),
    offset(0.15, "THREAD RELIEF", axis=2),
    offset(-0.15, "THREAD RELIEF", axis=2),
    offset(0.15, "FINISH FACE", axis=2),
)
"""Errors of a groove, at whose bottom the tool turns back between samples, and of a face."""

WALL_OFFSET = 0.15
"""Offset of the table of all surfaces, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundError:
    """Result of verifying an injected error."""

    error: InjectedError
    spots: tuple[tuple[str, DeviationSpot], ...]
    """Deviations beyond their uncertainty, with their workingsteps; the surest first."""
    verification: Verification

    @property
    def spot(self) -> DeviationSpot | None:
        """Surest deviation on the surface where the error must be found."""
        own = [spot for name, spot in self.spots if name == self.error.workingstep]
        return own[0] if own else None

    @property
    def least(self) -> float:
        """Least uncertainty where the error must be found, mm."""
        return min(
            spot.uncertainty
            for row in surface_deviations(self.verification)
            if row.workingstep == self.error.workingstep
            for spot in (row.gouge, row.excess)
        )

    @property
    def is_right(self) -> bool:
        """True if the error is found at its place with its size, or rightly nothing is."""
        if not self.error.size:
            return not self.spots
        if self.spot is None:
            return False
        share = self.spot.time / self.verification.facts.end if self.error.is_growing else 1.0
        return abs(self.spot.size - share * abs(self.error.size)) <= self.spot.uncertainty


def found(
    error: InjectedError,
    log: RunLog,
    program: PreparedProgram,
    *,
    folder: Path,
    request: VerificationRequest = REQUEST,
) -> FoundError:
    """Put an error into a log, and verify it."""
    path = error.make(log, program).write(folder / "log.parquet", program)
    if error.tool:
        program = widened(program, error.tool, error.radius)
    result = verified(path, program, request)
    spots = [
        (row.workingstep, spot)
        for row in surface_deviations(result)
        for spot in (row.gouge, row.excess)
        if spot.is_beyond
    ]
    spots.sort(key=lambda pair: -pair[1].least)
    return FoundError(error=error, spots=tuple(spots), verification=result)


def widened(program: PreparedProgram, tool: int, radius: float) -> PreparedProgram:
    """Let a tool be measured larger than programmed, in its radius or that of its nose."""
    shape = program.cutters[tool]
    assert shape is not None
    wide: Cutter | Insert
    if isinstance(shape, Cutter):
        wide = replace(shape, diameter=shape.diameter + 2.0 * radius)
    else:
        wide = replace(shape, nose_radius=shape.nose_radius + radius)
    return replace(program, cutters=program.cutters | {tool: wide})


def told(spot: DeviationSpot) -> str:
    """Size of a deviation, or its least size if its uncertainty says less."""
    if spot.size <= spot.uncertainty:
        return f"at least {spot.least:.4f}"
    return f"{spot.size:.4f} ± {spot.uncertainty:.4f}"


def shown(case: FoundError) -> str:
    """One line of the table."""
    spot, error = case.spot or (case.spots[0][1] if case.spots else None), case.error
    injected = f"{error.size:.4f}" if error.size else ""
    answer = "right" if case.is_right else "WRONG"
    if spot is None and error.size:
        return f"| {error.name} | {injected} | not found, ± {case.least:.4f} | | | no |"
    if spot is None:
        return f"| {error.name} | {injected} | nothing | | | {answer} |"
    place = ", ".join(f"{each:.1f}" for each in spot.position)
    name = next(name for name, each in case.spots if each is spot)
    return (
        f"| {error.name} | {injected} | {told(spot)} | {name} | "
        f"{place}; block {spot.block}; {spot.time:.1f} s | {answer} |"
    )


def errors(folder: Path) -> None:
    """Print the tables of injected errors."""
    bracket, shaft = prepared(BRACKET, REQUEST), prepared(SHAFT, SHAFT_REQUEST)
    for program, request, rate, cases in (
        (bracket, REQUEST, 100.0, ERRORS),
        (shaft, SHAFT_REQUEST, 100.0, SHAFT_ERRORS),
        (bracket, REQUEST, 10.0, (CLEAN, JITTER, *OFFSETS[:2])),
        (shaft, SHAFT_REQUEST, 10.0, (CLEAN, JITTER, *TURNED_OFFSETS[:2], *SHORT_OFFSETS)),
    ):
        is_fast = rate < 50.0
        log = run_log(program, rate=rate, feed=_fast if is_fast else _slow)
        feeds = "1000 mm/min" if is_fast else "at most 250 mm/min"
        print(f"{program.name}, {rate:g} Hz, {feeds}: {len(log.time)} positions")
        print("| error | mm | found mm | on | at mm | |\n|---|---|---|---|---|---|")
        for error in cases:
            print(shown(found(error, log, program, folder=folder, request=request)))


def walls(folder: Path) -> None:
    """Print whether each workingstep is found at 10 Hz when it is moved along each axis.

    A row in which a log of 100 Hz shows nothing on its surface either has nothing to find.
    """
    for part, request, axes in ((BRACKET, REQUEST, (0, 1, 2)), (SHAFT, SHAFT_REQUEST, (0, 2))):
        program = prepared(part, request)
        logs = [run_log(program, rate=rate, feed=_fast) for rate in (10.0, 100.0)]
        clean_places = found(CLEAN, logs[0], program, folder=folder, request=request)
        made = set(clean_places.verification.places.workingstep.tolist())
        print(f"{program.name}, 10 Hz, 1000 mm/min, offsets of {WALL_OFFSET:g} mm")
        print("| workingstep | " + " | ".join(f"{sign}{'XYZ'[axis]}" for axis in axes
              for sign in "+-") + " |")  # fmt: skip
        print("|---|" + "---|" * 2 * len(axes))
        for row, step in enumerate(program.steps):
            if row in made:
                cells = (
                    _found_wall(
                        offset(sign * WALL_OFFSET, step.workingstep, axis=axis),
                        logs, program, folder=folder, request=request,
                    )
                    for axis in axes
                    for sign in (1.0, -1.0)
                )  # fmt: skip
                print(f"| {step.workingstep} | " + " | ".join(cells) + " |", flush=True)


def _found_wall(
    error: InjectedError,
    logs: Sequence[RunLog],
    program: PreparedProgram,
    *,
    folder: Path,
    request: VerificationRequest,
) -> str:
    """True if an error is found in the first log, or shows in the second, denser one."""
    sparse = found(error, logs[0], program, folder=folder, request=request)
    if sparse.spot is not None:
        return told(sparse.spot)
    if sparse.spots:
        return f"on {sparse.spots[0][0]}: {told(sparse.spots[0][1])}"
    dense = found(error, logs[1], program, folder=folder, request=request)
    return f"not found, ± {sparse.least:.4f}" if dense.spots else "–"


def _slow(speed: Floats) -> Floats:
    return np.minimum(speed, SLOW)


def _fast(speed: Floats) -> Floats:
    return np.full_like(speed, FAST)


def lengths(folder: Path, most: int) -> None:
    """Print time and memory for logs of growing length, each in a process of its own."""
    program = prepared(BRACKET, REQUEST)
    duration = len(run_log(program, rate=1.0, feed=lambda speed: speed).time)
    for positions in (most // 10, most):
        log = run_log(program, rate=positions / duration, feed=lambda speed: speed)
        path = log.write(folder / "long.parquet", program)
        count = len(log.time)
        del log
        with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
            seconds, memory = pool.submit(measured, path).result()
        print(
            f"{count} positions: {seconds:.1f} s, {1e6 * seconds / count:.1f} µs each; "
            f"peak memory {memory:.0f} MB"
        )


def measured(path: Path) -> tuple[float, float]:
    """Time in s and peak memory in MB of a verification."""
    program = prepared(BRACKET, REQUEST)
    begin = time.perf_counter()
    verified(path, program, REQUEST)
    seconds = time.perf_counter() - begin
    # Not ru_maxrss, which begins with that of the parent.
    lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    peak = next(line for line in lines if line.startswith("VmHWM"))
    return seconds, float(peak.split()[1]) / 1024.0


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--positions", type=int, default=1_000_000)
    parser.add_argument("--walls", action="store_true", help="offsets of all surfaces alone")
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as name:
        if options.walls:
            walls(Path(name))
            return
        errors(Path(name))
        lengths(Path(name), options.positions)


if __name__ == "__main__":
    main()
