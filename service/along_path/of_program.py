"""Feeds along the paths of a STEP-NC program, within the limits of its plan."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from optimiser.advice import AdviceStatus, Plan
from optimiser.along_path.bounds import bounds_of
from optimiser.along_path.caps import CutBounds
from service.along_path.course import BlockLog, Part, PathSource
from service.along_path.run import FeedsAlongPath, along_path
from service.along_path.task import least_feed, task_of
from service.chosen import require_axes
from service.paths.toolpaths import paths_of, with_feeds
from service.progress import Tell, silent
from service.requests.advice import AdviceRequest
from service.simulation.setup import PreparedRun, prepared_program
from stepnc_model.post import block_feeds
from stepnc_model.post.blocks import Block
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.dialects import with_exact_stops, write
from stepnc_model.post.neutral import blocks_of
from stepnc_model.program import Program


def along_program(
    program: Program,
    plan: Plan,
    request: AdviceRequest,
    *,
    keeps_traces: bool = False,
    tell: Tell = silent,
) -> FeedsAlongPath:
    """Plan the feeds along the paths of a program that contains the advice of its plan.

    Parameters
    ----------
    keeps_traces : bool
        Whether feed, force and power are kept for plots.
    tell : callable
        Receives progress.

    Raises
    ------
    StepNcError
        When the machine cannot run the program.
    """
    require_axes(plan.machine)
    least = least_feed(request)
    bounds = {
        advice.workingstep.id: replace(found, least=least)
        for advice in plan.advices
        if advice.status is AdviceStatus.ADVISED and (found := bounds_of(advice)) is not None
    }

    def prepare(margin: float) -> PreparedRun:
        return prepared_program(
            program, plan.machine, plan.material, tell=silent, margin=margin
        )

    def bounds_at(part: Part) -> CutBounds | None:
        return bounds.get(part.name)

    task = replace(task_of(request, plan.machine), keeps_traces=keeps_traces)
    return along_path(PathSource(prepare=prepare, bounds=bounds_at), task, tell=tell)


def nc_lines_along(
    program: Program, along: FeedsAlongPath, control: Dialect, *, is_exact: bool = False
) -> Iterator[str]:
    """Generate NC code of a program at the planned feeds, line by line.

    Parameters
    ----------
    program : Program
        The program that was planned.
    is_exact : bool
        Whether corners get exact stops.
    """
    paths = with_feeds(paths_of(program), keep_going=False)
    blocks = blocks_of(program, paths.items, name=Path(program.name).stem)
    numbered = BlockLog((0, block) for block in blocks)
    fed = block_feeds.with_feeds(numbered, along.feeds)
    found: Iterator[Block] = (each.block for each in fed)
    return write(with_exact_stops(found, control) if is_exact else found, control)
