"""Check of a STEP-NC program or of NC code: its contents, its errors, and its uses."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from service.files import read_bytes
from service.inputs.numbers import program_numbers_in
from service.inputs.program_kind import ProgramKind, kind_for
from service.programs.needs import needs_of
from service.programs.reading import program_in, read_stock, tool_library, user_data, user_tools
from service.programs.remarks import all_findings, program_remarks, tell_remarks
from service.programs.toolpaths import Paths, paths_of
from service.progress import Tell, silent
from service.requests.kind_options import require_served
from service.simulation.code_setup import CodeSetup, GivenSetup, code_setup
from service.simulation.spindle_hand import turned_against
from service.verbs.check.request import CheckFiles, CheckRequest
from service.verbs.check.result import (
    CodeContents,
    CodeNeeds,
    FoundTool,
    MoveCount,
    ProgramContents,
)
from service.verbs.check.uses import uses_of
from simulator.removal.cutter import Cutter
from stepnc_model.editing.user_data import completed
from stepnc_model.errors import Finding, SchemaError, Severity, StepNcError
from stepnc_model.nc.moves import MoveKind, NcMoves
from stepnc_model.nc.program import read_program
from stepnc_model.nc.rewrite import rewrite
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.generate import KeptPaths


def run(
    request: CheckRequest, files: CheckFiles, *, tell: Tell = silent
) -> ProgramContents | CodeContents:
    """Read a program and check it; return its contents and findings.

    Raises
    ------
    StepNcError
        When the file is neither NC code nor one of Part 21, an option is not valid or does not
        serve the program, or NC code repeats blocks without end.
    """
    kind = kind_for(files.file, request.dialect or "")
    require_served(request, kind)
    require_served(files, kind)
    name = files.name or files.file.name
    if kind is ProgramKind.NC_CODE:
        if request.stock:
            raise StepNcError("--stock cannot be used with NC code: its check cuts nothing")
        return _code(request, files, name)
    found = _program(request, files, name, tell)
    tell_remarks(found.remarks, tell)
    return found


def _program(
    request: CheckRequest, files: CheckFiles, called: str, tell: Tell
) -> ProgramContents:
    """Contents and findings of a STEP-NC file."""
    file = Part21File.from_bytes(read_bytes(files.file), name=called)
    raw = read_stock(request.stock)
    try:
        program = program_in(file, units=request.units, name=called, stock=raw, tell=tell)
    except SchemaError as error:
        fault = Finding(
            severity=Severity.ERROR,
            message=str(error),
        )
        return ProgramContents(
            name=called,
            schemas=file.schemas,
            instances=len(file),
            program=None,
            findings=(*file.findings, fault),
        )
    library = tool_library(files.tools)
    program.tools = () if library is None else user_tools(library)
    program = completed(program, user_data(request)).program
    kept = KeptPaths()
    made = _paths(program, kept)
    found = program_remarks(program, kept) if isinstance(made, StepNcError) else made.remarks
    return ProgramContents(
        name=called,
        schemas=file.schemas,
        instances=len(file),
        program=program,
        findings=(*all_findings(program), *found),
        uses=uses_of(program, made),
        needs=needs_of(
            program, request, file=files.name or str(files.file), tools=_word(files.tools)
        ),
        remarks=found,
    )


def _word(path: Path | None) -> str:
    """Path as it is typed; empty for none."""
    return "" if path is None else str(path)


def _paths(program: Program, kept: KeptPaths) -> Paths | StepNcError:
    """Return the tool paths of a program, or the reason why they cannot be made."""
    try:
        return paths_of(program, path_of=kept)
    except StepNcError as error:
        return error


def _code(request: CheckRequest, files: CheckFiles, name: str) -> CodeContents:
    """Contents and findings of NC code, which is executed."""
    data = read_bytes(files.file)
    program = read_program(
        data,
        dialect=request.dialect,
        most_repeats=files.most_repeats,
        keeps_state=program_numbers_in(files.keeps_state),
    )
    given = GivenSetup(file=Path(name), tools=files.tools)
    setup = code_setup(program, given)
    return CodeContents(
        name=name,
        control=program.dialect.value,
        hints=program.hints,
        machine=program.machine.value,
        is_inch=program.unit > 1.0,
        blocks=len(program.text),
        executed=len(program.moves),
        frames=program.moves.frames,
        counts=tuple(_counts(program.moves)),
        is_lossless=rewrite(program, ()).data == program.text.data,
        findings=(
            *program.findings,
            *setup.library.findings,
            *setup.findings,
            *(each for _, each in turned_against(program, setup.library.by_number)),
        ),
        needs=CodeNeeds(
            tools=tuple(_tools(setup)),
            stock=str(setup.stock),
            is_stock_guessed=setup.is_stock_guessed,
            missing=setup.missing,
            command=setup.command,
        ),
    )


def _tools(setup: CodeSetup) -> Iterator[FoundTool]:
    """Tools of the comments of NC code."""
    for tool in setup.library.tools:
        guess = setup.guesses[tool.number]
        guessed = ("teeth", guess.has_teeth), ("cutting material", guess.has_edge)
        yield FoundTool(
            number=tool.number,
            kind=tool.kind.value,
            diameter=tool.shape.diameter if isinstance(tool.shape, Cutter) else 0.0,
            teeth=tool.teeth,
            guessed=", ".join(name for name, is_so in guessed if is_so),
            line=setup.lines.get(tool.number, 0),
        )


def _counts(moves: NcMoves) -> Iterator[MoveCount]:
    """Count the moves by tool, in the order of first use, and by kind."""
    numbers, firsts = np.unique(moves.tool, return_index=True)
    for number in numbers[np.argsort(firsts)]:
        for kind in MoveKind:
            chosen = (moves.tool == number) & (moves.kind == kind)
            if not chosen.any():
                continue
            feeds = moves.feed[chosen]
            known = feeds[~np.isnan(feeds)]
            yield MoveCount(
                tool=int(number),
                kind=kind.name.lower(),
                count=int(chosen.sum()),
                length=float(np.nansum(moves.length[chosen])),
                least_feed=float(known.min()) if len(known) else np.nan,
                greatest_feed=float(known.max()) if len(known) else np.nan,
                advisable=int(moves.is_advisable[chosen].sum()),
                splittable=int(moves.is_splittable[chosen].sum()),
            )
