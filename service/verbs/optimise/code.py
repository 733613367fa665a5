"""Feeds along the paths of NC code: read, plan within the limits of its tools, and rewrite.

Only F words change, and blocks are split.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from optimiser.along_path.caps import CapName, CutBounds
from optimiser.along_path.tool_bounds import (
    bounds_of_all,
    bounds_of_tool,
    is_unable,
    window_findings,
)
from optimiser.modes import Mode
from service.along_path.caution import CLEARANCE, Caution, rise_left
from service.along_path.code_job import CodeJob, job_of
from service.along_path.course import PathSource
from service.along_path.feed_ceilings import unraised_tools
from service.along_path.misuse import MisuseWatch
from service.along_path.output import profile_lines
from service.along_path.rewritten_code import CodeSource, written_code
from service.along_path.run import FeedsAlongPath
from service.along_path.task import least_feed, task_of
from service.files import read_bytes, write_atomically, write_lines
from service.inputs.numbers import program_numbers_in, tool_numbers_in
from service.knowledge.place import named_place, require_apart
from service.programs.machine_choice import load_material_named, require_axes, with_holding
from service.progress import Tell, silent
from service.requests.advice import AdviceRequest
from service.requests.fields import require_bounds
from service.simulation.code_paths import CodeBlocks, CodePaths
from service.simulation.code_setup import CodeSetup, GivenSetup, code_setup
from service.simulation.code_simulation import called_tool_findings, with_called_tools
from service.simulation.setup_file import setup_of
from service.simulation.spindle_speeds import (
    lacks_speed,
    least_cutting_speed,
    speeds_in,
    with_spindles,
)
from service.verbs.optimise.code_result import CodeAdvice
from service.verbs.optimise.request import AdviceFiles, output_of
from simulator.library import load_machine
from simulator.machine.cutting import STOPPED
from simulator.removal.cutter import THREADS
from simulator.removal.march_cache import MOST_BYTES, KeptMarches
from stepnc_model.errors import Finding, Severity, StepNcError
from stepnc_model.nc.advice import RewrittenCode
from stepnc_model.nc.program import NcProgram, read_program
from stepnc_model.nc.unroll import unrolled
from stepnc_model.plurals import counted
from stepnc_model.units import mm_from_um

NO_JOB = CodeJob()

NOTHING_WRITTEN = "nothing was written: no feed of this program could be chosen"

LEAST_COST = 0.05
"""Time from which the cost of the greatest rise is told, s."""


def optimise_code(
    request: AdviceRequest, files: AdviceFiles, *, tell: Tell = silent
) -> CodeAdvice:
    """Plan the feeds along the paths of NC code and write them into a copy of it.

    Raises
    ------
    StepNcError
        When a file, a name or a number is invalid, or the machine cannot run the program.
    """
    require_bounds(request)
    output = output_of(files, f".optimised{files.file.suffix}")
    name = files.name or files.file.name
    program = _program(request, files, tell)
    setup = code_setup(program, _given(request, files))
    setup.require_whole()
    library, request = setup.library, replace(request, stock=setup.stock)
    machine = load_machine(setup.machine)
    require_axes(machine)
    machine = with_holding(machine, files.holding)
    require_apart(named_place(files.kb), output, files.report, files.feeds_csv)
    material = load_material_named(setup.material)
    tell(f"material: {material.reason}")

    # Only the stock as given is cut more than twice, and there are two larger ones.
    marches = KeptMarches(3 * MOST_BYTES // 8)
    larger_marches = KeptMarches(5 * MOST_BYTES // 8, is_once=True)

    speeds = speeds_in(request.spindle)

    def paths_of(program: NcProgram) -> CodePaths:
        found = CodePaths(
            with_spindles(with_called_tools(program, library), speeds),
            machine,
            material,
            name=name,
            tools=library.by_number,
            stock=request.stock,
        )
        found.marches, found.larger_marches = marches, larger_marches
        return found

    code = paths_of(program)
    job = job_of(code, request, knowledge=files.kb)
    task = replace(
        task_of(request, machine), keeps_traces=files.report is not None, keeps_idle=True
    )
    rise = rise_left(program.text.data, request.greatest_rise)
    written = written_code(
        CodeSource(
            program=program,
            paths_of=paths_of,
            source_of=partial(source_of, request, rise=rise, job=job, setup=setup),
            mark=request.is_marked,
            rise=request.greatest_rise,
        ),
        task,
        tell=tell,
    )
    along, rewritten = written.along, written.rewritten
    misused = (each for each in written.doubts if each.severity is Severity.ERROR)
    met = (*along.faults(machine), *written.faults, *misused)
    faults = tuple(dict.fromkeys((*setup.faults_in_stock(met), *job.faults)))
    is_advised = _is_advised(along)
    written_to = output if is_advised and not files.dry_run else None
    found = CodeAdvice(
        program=name,
        machine=machine,
        material=material,
        control=program.dialect.value,
        frame=code.frame,
        along=along,
        rewritten=rewritten,
        findings=(
            *program.findings,
            *library.findings,
            *setup.findings,
            *called_tool_findings(program, library),
            *code.findings,
            *_windows(code),
            *(each for _, each in unraised_tools(code)),
            *job.findings,
            *_idle(code, along),
            *(each for each in written.doubts if each not in met),
            *_cost_of_rise(along, request.greatest_rise, rise),
            *_unchanged(rewritten),
            *(each for each in along.findings if each not in met and _is_told(each, code)),
            *setup.doubts(met),
            *along.too_deep,
            *along.above_limits,
            *written.findings,
            *faults,
        ),
        written=written_to,
        code=written_to,
        faults=faults,
        is_advised=is_advised,
    )
    _write(found, files, tell)
    return found


def _program(request: AdviceRequest, files: AdviceFiles, tell: Tell) -> NcProgram:
    """Read the program, and unroll its loops if that is requested."""
    data = read_bytes(files.file)
    program = read_program(
        data,
        dialect=request.dialect,
        most_repeats=files.most_repeats,
        keeps_state=program_numbers_in(request.keeps_state),
    )
    if not request.is_unrolled:
        return program
    straight = unrolled(program)
    tell(
        f"unrolled: {counted(straight.blocks, 'block')} from {straight.before}; lines are "
        "those of the unrolled program"
    )
    return straight.program


def _write(found: CodeAdvice, files: AdviceFiles, tell: Tell) -> None:
    """Write the program if any of its feeds could be chosen, and the feeds along the path."""
    if found.written is not None:
        write_atomically(found.written, found.rewritten.data)
        tell(f"written: {found.written}")
    elif not found.is_advised:
        tell(NOTHING_WRITTEN)
    if files.feeds_csv is not None:
        lines = write_lines(files.feeds_csv, profile_lines(found.along))
        tell(f"feeds: {files.feeds_csv} ({counted(lines, 'line')})")


def _is_advised(along: FeedsAlongPath) -> bool:
    """True if any feed of a program could be chosen, also where it stays as it is."""
    return any(
        step.plan is not None
        and step.name not in along.idle
        and any(name is not CapName.NO_STOCK for name in step.plan.shares)
        for step in along.steps
    )


def _given(request: AdviceRequest, files: AdviceFiles) -> GivenSetup:
    """Setup that the user gives for the program."""
    return GivenSetup(
        file=Path(files.name or files.file),
        tools=files.tools,
        unit=files.tools_unit,
        stock=request.stock,
        material=request.material,
        machine=request.machine,
        file_of_setup=setup_of(files.file, files.setup),
    )


def source_of(
    request: AdviceRequest,
    code: CodePaths,
    *,
    rise: float,
    job: CodeJob = NO_JOB,
    setup: CodeSetup | None = None,
) -> PathSource:
    """Paths of NC code with the bounds of their tools."""
    bounds = _bounds(code, request, job, setup)
    return PathSource(
        caution=Caution(
            fresh=code.uncut,
            larger=code.recalled,
            rise=rise,
            allows_plunge=request.allow_plunge,
            clearance=max(CLEARANCE, request.stock_margin_mm),
            misuse=MisuseWatch(tools=code.tools, allows_plunge=request.allow_plunge),
            unraised=dict(unraised_tools(code)).keys(),
        ),
        prepare=code.prepared,
        bounds=lambda part: bounds.get(part.name),
        numbered=lambda run: CodeBlocks(run.blocks, code),
    )


def _require_called(code: CodePaths, numbers: frozenset[int]) -> None:
    """Refuse tools that the program does not call."""
    called = set(code.program.moves.tool.tolist())
    if absent := sorted(numbers - called):
        there = ", ".join(f"T{number}" for number in sorted(called) if number > 0)
        raise StepNcError(
            f"T{absent[0]} of --keep or --finish: the program calls no such tool, but {there}"
        )


def _bounds(
    code: CodePaths, request: AdviceRequest, job: CodeJob, setup: CodeSetup | None
) -> dict[str, CutBounds]:
    """Bounds of the parts of a program by their names; parts that stay have none."""
    kept = tool_numbers_in(request.keep)
    finishing = tool_numbers_in(request.finish)
    _require_called(code, kept | finishing)
    roughness = None if request.roughness_um is None else mm_from_um(request.roughness_um)
    found: dict[str, CutBounds] = {}
    for part in code.parts:
        if part.tool in kept or part.tool not in code.tools or code.material is None:
            continue
        is_finishing = part.is_finishing or part.tool in finishing or request.mode is Mode.QC
        tool, material = code.tools[part.tool], code.material.material
        if is_unable(tool, code.machine, material):
            continue
        bounds = [
            bounds_of_tool(
                each,
                code.machine,
                material,
                quantile=request.safety,
                is_finishing=is_finishing,
                roughness=roughness,
                job=replace(
                    job.of_tool(tool.id),
                    finishing_speed=least_cutting_speed(code.program.moves, part.tool, each),
                ),
            )
            for each in ([tool] if setup is None else setup.plausible(tool, material))
        ]
        known = [each for each in bounds if each is not None]
        if known:
            found[part.name] = replace(
                bounds_of_all(known),
                least=least_feed(request),
                is_stock_guessed=setup is not None and setup.is_stock_guessed,
            )
    return found


def _windows(code: CodePaths) -> Iterator[Finding]:
    """Findings on tools without windows of their own in this material."""
    if code.material is None:
        return iter(())
    numbers = dict.fromkeys(part.tool for part in code.parts if part.tool in code.tools)
    tools = [code.tools[number] for number in numbers]
    return window_findings(tools, code.machine, code.material.material)


def _idle(code: CodePaths, along: FeedsAlongPath) -> Iterator[Finding]:
    """Findings on tools that meet no stock, and on a program of which nothing can change."""
    for part in code.parts:
        tool = code.tools.get(part.tool)
        # What taps and threading tools cut is not modelled.
        is_thread = tool is not None and tool.kind in THREADS
        if (
            part.name in along.idle
            and not is_thread
            and not lacks_speed(code.program.moves, part.tool)
        ):
            text = (
                f"{part.name} meets no stock: its feeds stay as programmed; do the stock and "
                f"{code.frame} have the same zero?"
            )
            yield Finding(severity=Severity.WARNING, message=text, line=code.line(part))
    if not code.can_change.any():
        yield Finding(
            severity=Severity.WARNING, message="no feed of this program may be chosen"
        )


def _cost_of_rise(along: FeedsAlongPath, most: float, rise: float) -> Iterator[Finding]:
    """Findings on the time that the greatest rise costs, and on code that rose before."""
    costs = [
        f"{step.name} {step.plan.rise_cost:.1f} s"
        for step in along.steps
        if step.plan is not None
        and step.name not in along.idle
        and step.plan.rise_cost > LEAST_COST
    ]
    if costs and rise == most:
        text = (
            f"feeds rise to at most {rise:g} times the programmed ones (--greatest-rise), "
            f"which costs {', '.join(costs)}"
        )
        yield Finding(severity=Severity.NOTE, message=text)
    if rise < most:
        text = (
            f"the feeds of this code rose before, as a comment says: they rise to at most "
            f"{rise:g} times what it has; for more, advise the code that it was made from"
        )
        yield Finding(severity=Severity.NOTE, message=text)


def _is_told(finding: Finding, code: CodePaths) -> bool:
    """True but for a stopped spindle that turns at a speed which is not known."""
    if finding.message != STOPPED:
        return True
    rows = [code.rows_of(int(block)) for block in code.blocks_at([finding.line])]
    return not all(bool(np.isnan(code.program.moves.spindle[each]).all()) for each in rows)


def _unchanged(rewritten: RewrittenCode) -> Iterator[Finding]:
    """Findings on blocks that did not get what was advised."""
    for each in rewritten.unchanged:
        what = "got one feed" if each.is_unsplit else "stays as it is"
        yield Finding(severity=Severity.NOTE, message=f"{what}: {each.reason}", line=each.line)
