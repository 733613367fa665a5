"""Feeds along the paths of NC code: read, plan within the limits of its tools, and rewrite.

Only F words change, and blocks are split.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from optimiser.along_path.caps import CapName, CutBounds
from optimiser.along_path.tool_bounds import bounds_of_tool, window_findings
from optimiser.modes import Mode
from service.along_path.caution import CLEARANCE, Caution, rise_left
from service.along_path.code_job import CodeJob, job_of
from service.along_path.course import PathSource
from service.along_path.output import profile_lines
from service.along_path.run import FeedsAlongPath
from service.along_path.task import least_feed, task_of
from service.along_path.written_code import CodeSource, written_code
from service.chosen import (
    DEFAULT_LATHE,
    DEFAULT_MILL,
    load_material_named,
    require_axes,
    with_holding,
)
from service.files import read_bytes, write_atomically, write_lines
from service.knowledge.place import named_place, require_apart
from service.numbers import tool_numbers_in
from service.reading import Tell, silent
from service.requests.advice import AdviceRequest
from service.requests.fields import require_bounds
from service.simulation.called_tools import called_tool_findings, with_called_tools
from service.simulation.code_paths import CodeBlocks, CodePaths
from service.verbs.optimise.code_result import CodeAdvice
from service.verbs.optimise.places import output_of
from service.verbs.optimise.request import AdviceFiles
from simulator.library import load_machine
from simulator.tool_files.read import ToolLibrary, read_tools
from stepnc_model.errors import Finding, Severity, StepNcError
from stepnc_model.nc.advice import RewrittenCode
from stepnc_model.nc.program import NcProgram, read_program
from stepnc_model.nc.unroll import unrolled
from stepnc_model.post.blocks import MachineType
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
    library = _tools(request, files)
    program = read_program(
        read_bytes(files.file), dialect=request.dialect, most_repeats=files.most_repeats
    )
    if request.is_unrolled:
        straight = unrolled(program)
        program = straight.program
        tell(
            f"unrolled: {straight.blocks} blocks from {straight.before}; lines are those of "
            "the unrolled program"
        )
    is_lathe = program.machine is MachineType.LATHE
    machine = load_machine(request.machine or (DEFAULT_LATHE if is_lathe else DEFAULT_MILL))
    require_axes(machine)
    machine = with_holding(machine, files.holding)
    require_apart(named_place(files.kb), output, files.report, files.feeds_csv)
    material = load_material_named(request.material)
    tell(f"material: {material.reason}")

    def paths_of(program: NcProgram) -> CodePaths:
        return CodePaths(
            with_called_tools(program, library),
            machine,
            material,
            name=name,
            tools=library.by_number,
            stock=request.stock,
        )

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
            source_of=partial(source_of, request, rise=rise, job=job),
            mark=request.is_marked,
            rise=request.greatest_rise,
        ),
        task,
        tell=tell,
    )
    along, rewritten = written.along, written.rewritten
    faults = tuple(dict.fromkeys((*along.faults(machine), *written.faults, *job.faults)))
    is_advised = _is_advised(along)
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
            *called_tool_findings(program, library),
            *code.findings,
            *_windows(code),
            *job.findings,
            *_idle(code, along),
            *written.doubts,
            *_cost_of_rise(along, request.greatest_rise, rise),
            *_unchanged(rewritten),
            *(each for each in along.findings if each not in faults),
            *along.above_limits,
            *written.findings,
            *faults,
        ),
        written=output if is_advised and not files.dry_run else None,
        faults=faults,
        is_advised=is_advised,
    )
    if found.written is not None:
        write_atomically(output, rewritten.data)
        tell(f"written: {output}")
    elif not is_advised:
        tell(NOTHING_WRITTEN)
    if files.feeds_csv is not None:
        lines = write_lines(files.feeds_csv, profile_lines(along))
        tell(f"feeds: {files.feeds_csv} ({lines} lines)")
    return found


def _is_advised(along: FeedsAlongPath) -> bool:
    """Whether any feed of a program could be chosen, also where it stays as it is."""
    return any(
        step.plan is not None
        and step.name not in along.idle
        and any(name is not CapName.NO_STOCK for name in step.plan.shares)
        for step in along.steps
    )


def _tools(request: AdviceRequest, files: AdviceFiles) -> ToolLibrary:
    """Read the tools; what NC code itself does not name must be given."""
    if files.tools is None or not request.stock:
        raise StepNcError("NC code names no tools and no stock: add --tools and --stock")
    if not request.material:
        raise StepNcError("NC code names no material: add --material (`stepnc materials`)")
    return read_tools(files.tools, unit=files.tools_unit)


def source_of(
    request: AdviceRequest, code: CodePaths, *, rise: float, job: CodeJob = NO_JOB
) -> PathSource:
    """Paths of NC code with the bounds of their tools."""
    bounds = _bounds(code, request, job)
    return PathSource(
        caution=Caution(
            fresh=code.uncut,
            rise=rise,
            allows_plunge=request.allow_plunge,
            clearance=max(CLEARANCE, request.stock_margin_mm),
        ),
        prepare=code.prepared,
        bounds=lambda part: bounds.get(part.name),
        numbered=lambda run: CodeBlocks(run.blocks, code),
    )


def _bounds(code: CodePaths, request: AdviceRequest, job: CodeJob) -> dict[str, CutBounds]:
    """Bounds of the parts of a program by their names; parts that stay have none."""
    kept = tool_numbers_in(request.keep)
    finishing = tool_numbers_in(request.finish)
    roughness = None if request.roughness_um is None else mm_from_um(request.roughness_um)
    found: dict[str, CutBounds] = {}
    for part in code.parts:
        if part.tool in kept or part.tool not in code.tools or code.material is None:
            continue
        is_finishing = part.is_finishing or part.tool in finishing or request.mode is Mode.QC
        bounds = bounds_of_tool(
            code.tools[part.tool],
            code.machine,
            code.material.material,
            quantile=request.safety,
            is_finishing=is_finishing,
            roughness=roughness,
            job=job.of_tool(code.tools[part.tool].id),
        )
        if bounds is not None:
            found[part.name] = replace(bounds, least=least_feed(request))
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
        if part.name in along.idle:
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


def _unchanged(rewritten: RewrittenCode) -> Iterator[Finding]:
    """Findings on blocks that did not get what was advised."""
    for each in rewritten.unchanged:
        what = "got one feed" if each.is_unsplit else "stays as it is"
        yield Finding(severity=Severity.NOTE, message=f"{what}: {each.reason}", line=each.line)
