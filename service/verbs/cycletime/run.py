"""Cycle time of a program: as programmed, predicted, and as logged."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from service.files import require_place, write_atomically, write_lines
from service.inputs.numbers import program_numbers_in
from service.inputs.program_kind import NO_TABLE, ProgramKind, kind_of_file
from service.programs.machine_choice import machine_for, require_axes
from service.programs.reading import read_completed, tool_library
from service.programs.toolpaths import paths_of, with_feeds
from service.progress import Tell, silent
from service.recording.logged_run import LoggedRun, read_logged_run
from service.requests.kind_options import require_served
from service.requests.runs import RunRequest
from service.simulation.code_simulation import IDLE, CodeRequest, dialect_of, from_code
from service.simulation.setup import PreparedRun
from service.simulation.setup_file import SetupFile, setup_of
from service.verbs.cycletime.request import CycleTimeFiles, CycleTimeRequest
from service.verbs.cycletime.result import CycleRow, CycleTimeResult, LosingStretch
from simulator.errors import SimulationError
from simulator.machine.block_times import BlockTimes, LossCause, block_times
from simulator.machine.interpreter import Numbered, interpret
from simulator.machine.virtual import MachineSetup, VirtualMachine
from simulator.motion.control import control_model
from simulator.motion.segments import Bools, axis_limits
from simulator.spec import Machine
from stepnc_model.errors import Finding, Severity, StepNcError
from stepnc_model.nc.advice import BlockAdvice
from stepnc_model.nc.moves import MoveKind
from stepnc_model.nc.program import NcProgram
from stepnc_model.nc.rewrite import rewrite
from stepnc_model.plurals import counted
from stepnc_model.post.blocks import Block, Circular, Linear
from stepnc_model.post.dialects import write
from stepnc_model.post.neutral import blocks_of

MOST_STRETCHES = 20
"""Stretches of blocks that are listed, those that lose most first."""

LEAST_LOSS = 1e-3
"""Share of the programmed feed that a modified program may keep above what is reached."""

WORTH = 0.01
"""Share of the predicted time from which a loss is worth a hint."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Source:
    """Program that is read anew each time its blocks are asked for."""

    request: CycleTimeRequest
    files: CycleTimeFiles
    is_program: bool
    """True for STEP-NC, false for NC code."""

    def code(self) -> PreparedRun:
        """Run of NC code, without what cannot be run."""
        request, files = self.request, self.files
        return from_code(
            CodeRequest(
                code=files.file,
                dialect=request.dialect,
                most_repeats=files.most_repeats,
                keeps_state=program_numbers_in(files.keeps_state),
            ),
            RunRequest(machine=request.machine or self._machine_of_setup()),
            program=None,
            keep_going=True,
        )

    def _machine_of_setup(self) -> str:
        """Name of the machine in the code's setup file; empty without one."""
        found = setup_of(self.files.file, self.files.setup)
        return found.machine if isinstance(found, SetupFile) else ""

    def opened(self, tell: Tell) -> tuple[Machine, Iterator[Numbered], tuple[Finding, ...]]:
        """Machine, numbered blocks, and what is left out of them."""
        request = self.request
        if not self.is_program:
            prepared = self.code()
            found = tuple(each for each in prepared.findings if each is not IDLE)
            return prepared.machine, prepared.blocks, found
        program = read_completed(
            self.files.file, request, tools=tool_library(self.files.tools), tell=tell
        ).program
        paths = with_feeds(paths_of(program, tell=tell), keep_going=False)
        blocks = blocks_of(program, paths.items, name=Path(program.name).stem)
        return machine_for(request.machine, program), enumerate(blocks, start=1), ()


def run(
    request: CycleTimeRequest, files: CycleTimeFiles, *, tell: Tell = silent
) -> CycleTimeResult:
    """Estimate the cycle time of a program, and write its modified program if asked for.

    Raises
    ------
    StepNcError
        When a file, the machine or an option is invalid, or the machine cannot run it.
    """
    kind = kind_of_file(files.file)
    require_served(request, kind)
    require_served(files, kind)
    is_program = kind is ProgramKind.STEP_NC
    if files.tools is not None and not is_program:
        raise StepNcError(NO_TABLE)
    source = _Source(request=request, files=files, is_program=is_program)
    if files.output is not None:
        require_place(files.output, apart_from=files.file)
        if is_program:
            dialect_of(files.output, request.dialect)
    machine, blocks, left_out = source.opened(tell)
    require_axes(machine)
    virtual = _virtual(machine, request)
    try:
        times = block_times(virtual.run(interpret(blocks, machine)), axis_limits(machine))
    except SimulationError as error:
        raise SimulationError(f"{files.file.name}: {error}") from error
    log = read_logged_run(files.log, tell=tell) if files.log else None
    names = ("", *virtual.workingsteps)
    if files.output is not None:
        _write_modified(source, times, files.output, tell)
    stretches = _stretches(times, names)
    total = _total(times, log)
    return CycleTimeResult(
        name=files.file.name,
        machine=machine,
        control=request.control,
        times=times,
        rows=_rows(times, names, log),
        total=total,
        stretches=stretches[:MOST_STRETCHES],
        hints=tuple(_hints(times, names, machine, least=WORTH * total.predicted)),
        log=Path(files.log).name if files.log else None,
        findings=(
            *files.log_findings,
            *left_out,
            *virtual.findings,
            *_doubts(machine, names, log),
        ),
    )


def _virtual(machine: Machine, request: CycleTimeRequest) -> VirtualMachine:
    """Machine without tools and stock, as only time counts."""
    try:
        control = control_model(
            request.control,
            axis_limits(machine),
            deviation=request.deviation_mm,
            planner=machine.planner,
        )
    except ValueError as error:
        text = f"machine '{machine.name}', control {request.control.value}: {error}"
        raise StepNcError(text) from error
    return VirtualMachine(MachineSetup(machine=machine, control=control))


def _doubts(machine: Machine, names: Sequence[str], log: LoggedRun | None) -> Iterator[Finding]:
    """Warn of a machine without a block time, and of a log of another program."""
    if machine.block_time is None:
        text = (
            f"machine '{machine.name}' has no block_time_s, so that the block rate limits "
            "nothing: find it with `stepnc blocktest` and `stepnc blockfit`"
        )
        yield Finding(severity=Severity.WARNING, message=text)
    logged = {name for name in log.workingstep if name} if log is not None else set()
    if logged and any(names) and not logged & set(names):
        text = (
            f"the log is of another program: it has workingsteps {', '.join(sorted(logged))}, "
            f"the program has {', '.join(filter(None, names))}"
        )
        yield Finding(severity=Severity.WARNING, message=text)


# Table


def _rows(
    times: BlockTimes, names: Sequence[str], log: LoggedRun | None
) -> tuple[CycleRow, ...]:
    """Rows by workingstep and tool in order of execution."""
    keys = np.column_stack([times.workingstep, times.tool])
    order = dict.fromkeys(map(tuple, keys.tolist()))
    return tuple(
        _row(
            times,
            (keys == key).all(axis=1),
            workingstep=names[key[0]],
            tool=key[1],
            actual=None if log is None else _actual(log, names[key[0]], key[1]),
        )
        for key in order
    )


def _total(times: BlockTimes, log: LoggedRun | None) -> CycleRow:
    whole = np.ones(len(times), dtype=np.bool_)
    actual = None
    if log is not None:
        time = log.time[log.running]
        actual = float(time[-1] - time[0])
    return _row(times, whole, workingstep="total", tool=None, actual=actual)


def _row(
    times: BlockTimes, rows: Bools, *, workingstep: str, tool: int | None, actual: float | None
) -> CycleRow:
    return CycleRow(
        workingstep=workingstep,
        tool=tool,
        blocks=int((times.is_rapid[rows] >= 0).sum()),
        programmed=float(times.programmed[rows].sum()),
        by_rate=float(times.by_rate[rows].sum()),
        predicted=float(times.predicted[rows].sum()),
        actual=actual,
    )


def _actual(log: LoggedRun, workingstep: str, tool: int) -> float | None:
    """Logged time of a tool in a workingstep, s; None where the log names neither."""
    rows = log.running
    seconds = np.diff(log.time[rows])
    fits = np.ones(len(seconds), dtype=np.bool_)
    names = log.workingstep[rows][:-1]
    tools = log.tool[rows][:-1]
    if not any(names) and np.isnan(tools).all():
        return None
    if any(names):
        fits &= np.array([name == workingstep for name in names], dtype=np.bool_)
    if not np.isnan(tools).all():
        fits &= tools == tool
    return float(seconds[fits].sum())


# Losses


def _stretches(times: BlockTimes, names: Sequence[str]) -> tuple[LosingStretch, ...]:
    """All stretches that lose time, those that lose most first."""
    cause = times.cause
    keys = np.column_stack([times.workingstep, cause])
    edges = np.flatnonzero(np.diff(keys, axis=0).any(axis=1)) + 1
    found = []
    for low, high in pairwise([0, *edges.tolist(), len(times)]):
        if low == high or cause[low] == LossCause.NONE:
            continue
        length = float(times.length[low:high].sum())
        programmed = float(times.programmed[low:high].sum())
        found.append(
            LosingStretch(
                workingstep=names[times.workingstep[low]],
                first=int(times.line[low]),
                last=int(times.line[high - 1]),
                blocks=high - low,
                spacing=length / (high - low),
                feed=length / programmed,
                reached=length / float(times.predicted[low:high].sum()),
                lost=float(times.lost[low:high].sum()),
                cause=LossCause(cause[low]),
            )
        )
    # Equal blocks lose the same but for its last bits, which differ between processors.
    return tuple(sorted(found, key=lambda each: -round(each.lost, 6)))


def _hints(
    times: BlockTimes, names: Sequence[str], machine: Machine, *, least: float
) -> Iterator[str]:
    """Spacing or tolerance in CAM that recovers the time lost to the block rate."""
    rate = times.cause == LossCause.BLOCK_RATE
    for number, name in enumerate(names):
        rows = rate & (times.workingstep == number) & (times.programmed > 0.0)
        lost = float((times.by_rate - times.by_axes)[rows].sum())
        if machine.block_time is None or not rows.any() or lost < least:
            continue
        now = float(np.median(times.length[rows]))
        feed = times.length[rows] / times.by_axes[rows]
        needed = machine.block_time * float(np.median(feed))
        place = f"workingstep '{name}': " if name else ""
        text = (
            f"{place}{lost:.2f} s for the block rate in {counted(int(rows.sum()), 'block')} of "
            f"{now:.4g} mm: points {needed:.4g} mm apart would give it back"
        )
        radii = times.radius[rows]
        radius = float(np.median(radii))
        if np.isfinite(radius):
            # The sagitta of a chord is s²/8R.
            better, before = (each**2 / (8.0 * radius) for each in (needed, now))
            text += (
                f"; on its curves, of radius {radius:.3g} mm, that is a chord tolerance of "
                f"{better:.2g} mm instead of {before:.2g} mm"
            )
        yield text


# Modified program


def _write_modified(source: _Source, times: BlockTimes, output: Path, tell: Tell) -> None:
    """Write NC code in which each feed is lowered to what block rate and axes allow."""
    share: dict[int, float] = {}
    for line, part in zip(times.line.tolist(), times.reached.tolist(), strict=True):
        share[line] = min(part, share.get(line, 1.0))
    code = None if source.is_program else source.code().code
    if code is not None:
        _write_rewritten(code, share, output, tell)
        return
    _, blocks, _ = source.opened(silent)
    changed = 0

    def lowered() -> Iterator[Block]:
        nonlocal changed
        for line, block in blocks:
            part = share.get(line, 1.0)
            if isinstance(block, Linear | Circular) and part < 1.0 - LEAST_LOSS:
                changed += 1
                rate = replace(block.rate, value=part * block.rate.value)
                yield replace(block, rate=rate)
            else:
                yield block

    dialect = dialect_of(output, source.request.dialect)
    count = write_lines(output, write(lowered(), dialect))
    lines = counted(count, "line")
    tell(f"written: {output} ({lines}, feed lowered in {counted(changed, 'block')})")


def _write_rewritten(
    code: NcProgram, share: dict[int, float], output: Path, tell: Tell
) -> None:
    """Write code of any origin with lower feeds; all else stays byte for byte."""
    moves, lines = code.moves, code.text.lines[code.moves.block]
    is_fed = np.isin(moves.kind, (MoveKind.LINE, MoveKind.ARC)) & (moves.feed > 0.0)
    feeds: dict[int, float] = {}
    blocks: dict[int, int] = {}
    for row in np.flatnonzero(is_fed).tolist():
        line = int(lines[row])
        feeds[line] = min(float(moves.feed[row]), feeds.get(line, np.inf))
        blocks[line] = int(moves.block[row])
    advice = [
        BlockAdvice(block=blocks[line], ends=(1.0,), feeds=(part * feeds[line],))
        for line, part in sorted(share.items())
        if line in feeds and part < 1.0 - LEAST_LOSS
    ]
    found = rewrite(code, advice)
    write_atomically(output, found.data)
    left = f", {len(found.unchanged)} left as they are" if found.unchanged else ""
    tell(f"written: {output} (feed lowered in {counted(found.changed, 'block')}{left})")
