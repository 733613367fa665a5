"""NC code of a STEP-NC program."""

from service.files import require_place, sibling, write_lines
from service.inputs.program_kind import require_step_nc
from service.programs.reading import read_completed, tool_library
from service.programs.toolpaths import nc_lines, paths_for_code
from service.progress import Tell, silent
from service.verbs.post.request import PostFiles, PostRequest
from service.verbs.post.result import PostResult
from stepnc_model.plurals import counted
from stepnc_model.post.blocks import Cycles

NO_CODE = (
    "post writes code of STEP-NC programs: what NC code says beside its moves, as coolant, "
    "stops and offsets, is not carried over to another control"
)
"""Reason why NC code is not posted."""


def run(request: PostRequest, files: PostFiles, *, tell: Tell = silent) -> PostResult:
    """Write NC code for a control.

    Raises
    ------
    StepNcError
        When the file is NC code, a path cannot be generated, the control cannot do it, or the
        file cannot be written.
    """
    control = request.control
    output = files.output or sibling(files.file, control.suffix)
    require_place(output, apart_from=files.file)
    require_step_nc(files.file, NO_CODE)
    program = read_completed(
        files.file, request, tools=tool_library(files.tools), tell=tell
    ).program
    paths = paths_for_code(program, keep_going=request.keep_going, tell=tell)
    cycles = Cycles.OWN if request.cycles else Cycles.EXPANDED
    lines = nc_lines(
        paths, control, cycles, is_exact=request.exact_path, is_adaptive=request.adaptive_feed
    )
    count = write_lines(output, lines)
    tell(f"written: {output} ({counted(count, 'line')})")
    return PostResult(paths=paths, control=control, written=output, lines=count)
