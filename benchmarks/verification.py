"""Verification of logged positions: injected errors found, and the speed for long logs.

The bracket runs on vmc15 with exact stop, at 100 Hz with feeds of at most 250 mm/min, and at
10 Hz with all feeds at 1000 mm/min. Errors are put into the positions, as the scales would log
them. ``python -m benchmarks.verification --positions 1000000``
"""

import argparse
import resource
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pyarrow as pa
from pyarrow import parquet

from service.requests.verification import VerificationRequest
from service.verification.facts import DeviationSpot, surface_deviations
from service.verification.prepared import PreparedProgram, prepared
from service.verification.run import Verification, verified
from simulator.motion.control import control_model
from simulator.motion.model_name import ControlModelName
from simulator.motion.segments import Bools, Floats, Ints, axis_limits
from simulator.removal.cutter import Cutter
from simulator.verification.sweep import FAR

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
        """Whether a position is of a workingstep, (N,)."""
        names = [each.workingstep for each in program.steps]
        return np.asarray(self.workingstep == names.index(workingstep))

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
    radius: float = 0.0
    """Amount by which the tool of the finished pockets is larger, mm."""
    is_exact: bool = True
    """Whether the size must be found within the uncertainty."""


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


def skipped_pass(log: RunLog, program: PreparedProgram) -> RunLog:
    """Lift the tool over the last long cut of the step."""
    rows = log.within(program, "MILL STEP") & (log.position[:, 2] < -7.9)
    blocks, counts = np.unique(log.block[rows], return_counts=True)
    position = log.position.copy()
    position[rows & (log.block == blocks[counts.argmax()]), 2] += 20.0
    return replace(log, position=position)


def backlash(log: RunLog, _: PreparedProgram) -> RunLog:
    """Leave X behind by 0.02 mm wherever it moves down."""
    step = np.sign(np.diff(log.position[:, 0], prepend=log.position[0, 0]))
    moved = np.maximum.accumulate(np.where(step != 0.0, np.arange(len(step)), 0))
    position = log.position.copy()
    position[:, 0] += np.where(step[moved] < 0.0, 0.02, 0.0)
    return replace(log, position=position)


def drift(log: RunLog, _: PreparedProgram) -> RunLog:
    """Let X grow by 0.05 mm over the run."""
    position = log.position.copy()
    position[:, 0] += 0.05 * log.time / log.time[-1]
    return replace(log, position=position)


def lost_second(log: RunLog, program: PreparedProgram) -> RunLog:
    """Lose a second in which the tool goes around a corner of the open pocket."""
    rows = np.flatnonzero(log.within(program, "FINISH OPEN POCKET"))
    low = rows[log.position[rows, 2] < -9.9]
    turns = np.flatnonzero(np.diff(log.block[low]) != 0)
    middle = log.time[low[turns[len(turns) // 2]]]
    kept = np.abs(log.time - middle) > 0.5
    return RunLog(
        time=log.time[kept], position=log.position[kept], tool=log.tool[kept],
        workingstep=log.workingstep[kept], block=log.block[kept],
    )  # fmt: skip


def clean(log: RunLog, _: PreparedProgram) -> RunLog:
    """Leave the log as it is."""
    return log


CLEAN = InjectedError(name="none", size=0.0, workingstep="", make=clean)
OFFSETS = (offset(0.3), offset(0.15), offset(0.0254))
ERRORS = (
    CLEAN,
    *OFFSETS,
    offset(0.0254, "FINISH CONTOUR"),
    InjectedError(
        name="skipped pass", size=FAR, workingstep="MILL STEP", make=skipped_pass
    ),
    InjectedError(name="backlash of X", size=0.02, workingstep="FINISH POCKET", make=backlash),
    InjectedError(
        name="drift of X to 0.05", size=0.04, workingstep="FINISH POCKET", make=drift,
        is_exact=False,
    ),
    InjectedError(
        name="radius of T4", size=0.05, workingstep="FINISH POCKET", make=clean, radius=0.05
    ),
    InjectedError(name="lost second", size=0.0, workingstep="", make=lost_second),
)  # fmt: skip


SHAFT_ERRORS = (
    CLEAN,
    *(offset(size, "FINISH CONTOUR") for size in (0.3, 0.15, 0.0254)),
    offset(0.0254, "FINISH FACE", axis=2),
    offset(0.15, "THREAD RELIEF"),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundError:
    """What a verification says of an injected error."""

    error: InjectedError
    spots: tuple[tuple[str, DeviationSpot], ...]
    """Deviations beyond their uncertainty, with their workingsteps; the greatest first."""
    verification: Verification

    @property
    def spot(self) -> DeviationSpot | None:
        """Greatest deviation on the surface where the error must be found."""
        own = [spot for name, spot in self.spots if name == self.error.workingstep]
        return own[0] if own else None

    @property
    def is_right(self) -> bool:
        """Whether the error is found at its place with its size, or rightly nothing is."""
        if not self.error.size:
            return not self.spots
        if self.spot is None:
            return False
        if not self.error.is_exact:
            return self.spot.size >= 0.5 * self.error.size
        return abs(self.spot.size - self.error.size) <= self.spot.uncertainty


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
    if error.radius:
        four = program.cutters[4]
        assert isinstance(four, Cutter)
        wide = replace(four, diameter=four.diameter + 2.0 * error.radius)
        program = replace(program, cutters=program.cutters | {4: wide})
    result = verified(path, program, request)
    spots = [
        (row.workingstep, spot)
        for row in surface_deviations(result)
        for spot in (row.gouge, row.excess)
        if spot.is_beyond
    ]
    spots.sort(key=lambda pair: -pair[1].size)
    return FoundError(error=error, spots=tuple(spots), verification=result)


def shown(case: FoundError) -> str:
    """One line of the table."""
    spot, error = case.spot or (case.spots[0][1] if case.spots else None), case.error
    injected = f"{error.size:.4f}" if error.size else ""
    answer = "right" if case.is_right else "WRONG"
    if spot is None:
        return f"| {error.name} | {injected} | nothing | | | {answer} |"
    place = ", ".join(f"{each:.1f}" for each in spot.position)
    name = next(name for name, each in case.spots if each is spot)
    return (
        f"| {error.name} | {injected} | {spot.size:.4f} ± {spot.uncertainty:.4f} | {name} | "
        f"{place}; block {spot.block}; {spot.time:.1f} s | {answer} |"
    )


def errors(folder: Path) -> None:
    """Print the tables of injected errors."""
    bracket, shaft = prepared(BRACKET, REQUEST), prepared(SHAFT, SHAFT_REQUEST)
    for program, request, rate, cases in (
        (bracket, REQUEST, 100.0, ERRORS),
        (shaft, SHAFT_REQUEST, 100.0, SHAFT_ERRORS),
        (bracket, REQUEST, 10.0, (CLEAN, *OFFSETS[:2])),
    ):
        is_fast = rate < 50.0
        log = run_log(program, rate=rate, feed=_fast if is_fast else _slow)
        feeds = "1000 mm/min" if is_fast else "at most 250 mm/min"
        print(f"{program.name}, {rate:g} Hz, {feeds}: {len(log.time)} positions")
        print("| error | mm | found mm | on | at mm | |\n|---|---|---|---|---|---|")
        for error in cases:
            print(shown(found(error, log, program, folder=folder, request=request)))


def _slow(speed: Floats) -> Floats:
    return np.minimum(speed, SLOW)


def _fast(speed: Floats) -> Floats:
    return np.full_like(speed, FAST)


def lengths(folder: Path, most: int) -> None:
    """Print time and memory for logs of growing length."""
    program = prepared(BRACKET, REQUEST)
    duration = len(run_log(program, rate=1.0, feed=lambda speed: speed).time)
    for positions in (most // 10, most):
        log = run_log(program, rate=positions / duration, feed=lambda speed: speed)
        path = log.write(folder / "long.parquet", program)
        begin = time.perf_counter()
        verified(path, program, REQUEST)
        seconds = time.perf_counter() - begin
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
        print(
            f"{len(log.time)} positions: {seconds:.1f} s, "
            f"{1e6 * seconds / len(log.time):.1f} µs each; peak memory {memory:.0f} MB"
        )


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--positions", type=int, default=1_000_000)
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as name:
        errors(Path(name))
        lengths(Path(name), options.positions)


if __name__ == "__main__":
    main()
