"""Optimisation of a STEP-NC program: read, plan, write back."""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from optimiser.advice import AdviceStatus, Plan
from optimiser.cuts.source import along_paths
from optimiser.modes import Mode
from optimiser.optimise import optimise_program
from optimiser.planning.formulate import OptimisationTask
from service.files import (
    require_places,
    sibling,
    write_atomically,
    write_lines,
)
from service.knowledge.place import named_place, require_apart
from service.knowledge.plan_corrections import factors_for, finding_of, with_corrections
from service.programs.advice_records import changes_of, lost_plunge_feeds
from service.programs.machine_choice import (
    machine_for,
    material_for,
    require_axes,
    with_holding,
)
from service.programs.needs import needs_of
from service.programs.reading import read_completed, selected, tool_library
from service.programs.refusals import Writable, advisable, apart_from
from service.progress import Progress, Tell, silent
from service.requests.advice import AdviceRequest
from service.requests.fields import fields_of, require_bounds
from service.requests.kind_options import OF_PATHS, changed_values
from service.verbs.optimise.plan_record import depth_notes
from service.verbs.optimise.plan_result import ProgramAdvice
from service.verbs.optimise.request import AdviceFiles, output_of
from simulator.spec import Certainty, Machine, MaterialMatch
from stepnc_model.editing import writeback
from stepnc_model.editing.file_profile import FileProfile, RecordChoice
from stepnc_model.editing.user_data import Completed
from stepnc_model.editing.withdrawal import without_user_data
from stepnc_model.errors import Finding, Severity, StepNcError
from stepnc_model.part21.reader import Part21File
from stepnc_model.plurals import counted
from stepnc_model.post.dialect import Dialect
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.toolpath.generate import KeptPaths
from stepnc_model.toolpath.task import stock_of
from stepnc_model.units import mm_from_um

if TYPE_CHECKING:
    from optimiser.cuts.fixtured_stock import StockMap
    from service.along_path.run import FeedsAlongPath
    from service.knowledge.verbs import AcceptedFactor
    from service.simulation.confirmation import Confirmation
    from simulator.tool_files.read import ToolLibrary
    from simulator.tools.tool_table import TableTool
    from stepnc_model.entities.executables import Setup
    from stepnc_model.part21.values import Ref

NOTHING_WRITTEN = "nothing was written: no workingstep was advised"


def advise_program(
    request: AdviceRequest, files: AdviceFiles, *, tell: Tell = silent
) -> ProgramAdvice:
    """Read a program, optimise its feeds and write the optimised program.

    Raises
    ------
    StepNcError
        When the file, a name, a limit or an output is invalid; nothing is written.
    """
    _require_sense(request, files)
    library, paths = tool_library(files.tools, files.tools_unit), KeptPaths()
    task = _task(request, library, paths)
    output = output_of(files, ".optimised.stpnc")
    nc_place = _nc_place(request, files, output)
    require_apart(named_place(files.kb), output, files.report, files.feeds_csv, nc_place)
    whole = _read_whole(request, files, library, tell)
    program = whole.program
    profile = _profile(request, program)
    chosen = selected(program, request.workingsteps)
    findings = program.file.findings + program.model.findings()
    possible = advisable(program, chosen, keep_going=request.keep_going)
    chosen = possible.steps
    machine = with_holding(machine_for(request.machine, program), files.holding)
    if request.is_confirmed:
        _require_run(program, chosen, machine)
    match = material_for(request.material, program)
    tell(f"material: {match.reason}")
    factors = _factors(request, files, program, chosen, machine=machine, match=match)
    notes = _factor_notes(factors, request.safety, tell)
    wanted = {int(step.ref) for step in chosen}
    plan = optimise_program(
        program,
        machine=machine,
        material=match,
        task=replace(
            task,
            force_factors={each.tool: each.centre for each in factors},
            learned_safety_factors={each.tool: each.factor / each.centre for each in factors},
        ),
        selected=lambda step: int(step.ref) in wanted,
        progress=Progress(tell, total=len(chosen)),
    )
    told = _remarks(program, paths, tell)
    notes = (*notes, *depth_notes(program, plan, whole.attributes))
    plan = replace(
        _with_file_findings(plan, (*findings, *notes, *told), match),
        refused=(*possible.refused, *plan.refused),
    )
    writable = apart_from(program, changes_of(plan), plan.refused)
    changes = writable.changes
    unwritten = _unwritten(program, plan, writable, profile, tell)
    plan, told = replace(plan, findings=(*plan.findings, *unwritten)), (*told, *unwritten)
    data = (
        writeback.write(writable.program, changes, profile) if changes else program.source.data
    )
    if changes and factors and profile is FileProfile.OPTIMISATION:
        data = with_corrections(_read_again(program, data), factors)
    confirmation = _confirmed(request, program, plan, data, tell)
    along = _along(request, files, program, plan, data, tell)
    plan = replace(plan, findings=(*plan.findings, *(along.above_limits if along else ())))
    if request.nc_control is not None and nc_place is not None:
        # NC code first: where it cannot be made, nothing is written.
        code = _nc_code(_read_again(program, data), request, along, tell)
        if not files.dry_run:
            tell(f"NC code: {nc_place} ({counted(write_lines(nc_place, code), 'line')})")
    if along is not None and request.writes_toolpaths:
        plan, data = _with_tool_paths(plan, _read_again(program, data), along, profile, tell)
    written = None
    if not files.dry_run:
        kept = data if files.in_place else _without_given(whole, data)
        written = _write(output, kept, tell) if changes else None
        if written is None:
            tell(NOTHING_WRITTEN)
    _write_feeds(files, along, tell)
    _tell_conflicts(plan, tell)
    return ProgramAdvice(
        plan=plan,
        written=written,
        code=None if files.dry_run else nc_place,
        control=request.nc_control,
        confirmation=confirmation,
        along=along,
        told=told,
        is_advised=bool(changes),
    )


def _unwritten(
    program: Program, plan: Plan, writable: Writable, profile: FileProfile | None, tell: Tell
) -> tuple[Finding, ...]:
    """Tell what is advised and not written."""
    lost = () if profile is not None else lost_plunge_feeds(program, plan)
    found = (*writable.findings, *lost)
    for each in found:
        tell(str(each))
    return found


def _confirmed(
    request: AdviceRequest, program: Program, plan: Plan, data: bytes, tell: Tell
) -> "Confirmation | None":
    """Comparison of a plan with its simulated run, if it was requested."""
    if not request.is_confirmed:
        return None
    from service.simulation.confirm import confirm  # noqa: PLC0415 (numba takes a second)

    return confirm(plan, program, _read_again(program, data), tell=tell)


def _along(
    request: AdviceRequest,
    files: AdviceFiles,
    program: Program,
    plan: Plan,
    data: bytes,
    tell: Tell,
) -> "FeedsAlongPath | None":
    """Feeds along the paths of an advised program, if they were requested."""
    if not request.is_along_path:
        return None
    from service.along_path.program_feeds import along_program  # noqa: PLC0415 (numba)

    return along_program(
        _read_again(program, data),
        plan,
        request,
        keeps_traces=files.report is not None,
        tell=tell,
    )


def _without_given(whole: Completed, data: bytes) -> bytes:
    """Bytes of an advised program without the data that the request gave."""
    if not whole.attributes:
        return data
    return without_user_data(_read_again(whole.program, data), whole)


def _factors(
    request: AdviceRequest,
    files: AdviceFiles,
    program: Program,
    chosen: tuple[ResolvedWorkingstep, ...],
    *,
    machine: Machine,
    match: MaterialMatch,
) -> "tuple[AcceptedFactor, ...]":
    """Accepted corrections of k_c for the tools of some workingsteps."""
    if not request.has_corrections:
        return ()
    return factors_for(
        files.kb,
        program,
        chosen,
        machine=machine,
        material=match,
        safety=request.safety,
    )


def _factor_notes(
    factors: "tuple[AcceptedFactor, ...]", safety: float, tell: Tell
) -> tuple[Finding, ...]:
    """Tell which corrections of k_c are used, and return the notes."""
    notes = tuple(finding_of(each, safety=safety) for each in factors)
    for note in notes:
        tell(note.message)
    return notes


def _remarks(program: Program, paths: KeptPaths, tell: Tell) -> tuple[Finding, ...]:
    """Tell the warnings about a program that every command gives."""
    from service.programs.remarks import program_remarks, tell_remarks  # noqa: PLC0415 (shapely)

    found = program_remarks(program, paths)
    tell_remarks(found, tell)
    return found


def _with_tool_paths(
    plan: Plan,
    program: Program,
    along: "FeedsAlongPath",
    profile: FileProfile | None,
    tell: Tell,
) -> tuple[Plan, bytes]:
    """Write feeds along the paths into the program; the plan gets what could not be written."""
    from service.along_path.path_file import with_tool_paths  # noqa: PLC0415 (numpy, shapely)

    # Without records a file is for readers that know the standard only.
    file = with_tool_paths(program, along, profile or FileProfile.STANDARD)
    tell(f"tool paths written into the program: {file.count}")
    return replace(plan, findings=(*plan.findings, *file.findings)), file.data


def _read_whole(
    request: AdviceRequest, files: AdviceFiles, library: "ToolLibrary | None", tell: Tell
) -> Completed:
    """Read a program; refuse one that lacks data, with all of them as one command."""
    whole = read_completed(files.file, request, name=files.name, tools=library, tell=tell)
    if not request.keep_going:
        tools = "" if files.tools is None else str(files.tools)
        name = files.name or str(files.file)
        needs_of(whole.program, request, file=name, tools=tools).require_whole()
    return whole


def _write(output: Path, data: bytes, tell: Tell) -> Path:
    """Write the optimised program."""
    write_atomically(output, data)
    tell(f"written: {output}")
    return output


def _write_feeds(files: AdviceFiles, along: "FeedsAlongPath | None", tell: Tell) -> None:
    """Write the table of feeds, where it was asked for."""
    if files.feeds_csv is not None and along is not None:
        from service.along_path.output import profile_lines  # noqa: PLC0415 (numpy)

        lines = write_lines(files.feeds_csv, profile_lines(along))
        tell(f"feeds: {files.feeds_csv} ({counted(lines, 'line')})")


def _require_sense(request: AdviceRequest, files: AdviceFiles) -> None:
    """Refuse numbers out of bounds, and options that have no effect."""
    require_bounds(request)
    if request.is_exact_path and request.nc_control is None:
        raise StepNcError("--exact-path is of NC code, and needs --nc")
    if request.is_along_path:
        return
    if request.levels is not None or files.feeds_csv is not None:
        raise StepNcError("--levels and --feeds-csv need --along-path")
    if request.smooth_share is not None:
        raise StepNcError("--smooth needs --along-path")
    if request.writes_toolpaths:
        raise StepNcError("--write-toolpaths needs --along-path")
    flags = {each.name: each.about.flag for each in fields_of(type(request))}
    for name in changed_values(request):
        if name in OF_PATHS:
            raise StepNcError(f"{flags[name]} needs --along-path")


def _require_run(
    program: Program, chosen: tuple[ResolvedWorkingstep, ...], machine: Machine
) -> None:
    """Refuse confirmation of workingsteps that cannot be run, before any work is done."""
    require_axes(machine)
    for step in chosen:
        if stock_of(program, step.setup) is None:
            text = f"'{step.id}' cannot be confirmed: the file defines no raw part"
            raise StepNcError(f"{text}; name one with --stock")


def _tell_conflicts(plan: Plan, tell: Tell) -> None:
    for each in plan.refused:
        tell(f"left as programmed: '{each.id}' ({each.ref}): {each.reason}")
    conflicts = [each for each in plan.advices if each.status is AdviceStatus.INFEASIBLE]
    if conflicts:
        names = ", ".join(
            f"'{each.workingstep.id}' ({each.workingstep.ref})" for each in conflicts
        )
        tell(f"infeasible, left as programmed: {names}")


def _profile(request: AdviceRequest, program: Program) -> FileProfile | None:
    """Form of the records; None for no records."""
    # The record schema has no entity for least cost.
    if request.records is RecordChoice.NONE or request.mode is Mode.CC:
        return None
    chosen = request.profile or writeback.usual_profile(program)
    return writeback.profile_for(program, chosen)


def _task(
    request: AdviceRequest, library: "ToolLibrary | None", paths: KeptPaths
) -> OptimisationTask:
    """Build the optimiser's task from a request, in internal units."""
    tools = () if library is None else library.tools
    roughness = request.roughness_um
    return OptimisationTask(
        mode=request.mode,
        free=frozenset(request.free),
        roughness=None if roughness is None else mm_from_um(roughness),
        roughness_quantile=request.roughness_quantile,
        tool_change=request.tool_change_s,
        wipers=frozenset(tool.id for tool in tools if tool.has_wiper),
        front=request.has_pareto,
        safety=request.safety,
        centre_cutting={**request.centre_cutting, **_centre_cutting(tools)},
        allow_plunge=request.allow_plunge,
        source=partial(
            along_paths, is_run=request.is_confirmed, body_map=_body_map, path_of=paths
        ),
        keep_going=request.keep_going,
        ignores_records=request.ignore_record,
    )


def _body_map(
    program: Program, setup: "Ref[Setup] | None", *, is_turning: bool, cell: float | None
) -> "StockMap | None":
    """Map of a raw part that is a body; None if it is a box or a bar."""
    from service.programs.raw_stock import body_map  # noqa: PLC0415 (numpy)

    return body_map(program, setup, is_turning=is_turning, cell=cell)


def _centre_cutting(tools: tuple["TableTool", ...]) -> dict[str, bool]:
    """True if tools cut over centre, by tool id; only tools for which the table says so."""
    said = {tool.id: tool.centre_cutting for tool in tools}
    return {name: does for name, does in said.items() if does is not None}


def _nc_place(request: AdviceRequest, files: AdviceFiles, output: Path) -> Path | None:
    """Output path of the NC code, next to the optimised program; None if not requested."""
    if request.nc_control is None:
        return None
    place = sibling(output, request.nc_control.suffix)
    require_places([place], apart_from=[files.file, output, files.report, files.feeds_csv])
    return place


def _nc_code(
    program: Program, request: AdviceRequest, along: "FeedsAlongPath | None", tell: Tell
) -> Iterator[str]:
    """Generate NC code of the optimised program."""
    control, is_exact = request.nc_control or Dialect.LINUXCNC, request.is_exact_path
    from service.programs.toolpaths import nc_lines, paths_of, with_feeds  # noqa: PLC0415 (numpy, shapely)

    if along is not None:
        from service.along_path.program_feeds import nc_lines_along  # noqa: PLC0415 (numpy, shapely)

        return nc_lines_along(program, along, control, is_exact=is_exact)
    paths = with_feeds(paths_of(program, tell=tell), keep_going=False)
    return nc_lines(paths, control, is_exact=is_exact)


def _read_again(program: Program, data: bytes) -> Program:
    """Parse a program again from its changed bytes."""
    file = Part21File.from_bytes(data, name=program.name)
    return program.changed(file)


def _with_file_findings(
    plan: Plan, findings: tuple[Finding, ...], match: MaterialMatch
) -> Plan:
    """Add the findings from reading, and how the material was matched, to a plan."""
    guess = match.certainty is Certainty.GUESS
    said = Finding(severity=Severity.WARNING if guess else Severity.NOTE, message=match.reason)
    return replace(plan, findings=(*findings, said, *plan.findings))
