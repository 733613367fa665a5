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
from service.programs.machine_choice import require_axes
from service.programs.toolpaths import paths_of, with_feeds
from service.progress import Tell, silent
from service.requests.advice import AdviceRequest
from service.simulation.setup import PreparedRun, prepared_program, same_id
from stepnc_model.post import block_feeds
from stepnc_model.post.blocks import Block
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.dialects import with_exact_stops, write
from stepnc_model.post.neutral import blocks_of
from stepnc_model.programs.program import Program, ResolvedWorkingstep


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
    bounds = _bounds(program, plan, least_feed(request))

    def prepare(margin: float) -> PreparedRun:
        return prepared_program(
            program, plan.machine, plan.material, tell=silent, margin=margin
        )

    def bounds_at(part: Part) -> CutBounds | None:
        return bounds.get(part.name)

    task = replace(task_of(request, plan.machine), keeps_traces=keeps_traces)
    return along_path(PathSource(prepare=prepare, bounds=bounds_at), task, tell=tell)


def _bounds(program: Program, plan: Plan, least: float) -> dict[str, CutBounds]:
    """Bounds along the path by the id of the workingstep, by which a run tells them apart.

    Raises
    ------
    SchemaError
        If an id stands for workingsteps with different operations.
    """
    bounds: dict[str, CutBounds] = {}
    first: dict[str, ResolvedWorkingstep] = {}
    for advice in plan.advices:
        found = bounds_of(advice) if advice.status is AdviceStatus.ADVISED else None
        if found is None:
            continue
        step = advice.workingstep
        other = first.setdefault(step.id, step)
        if other.operation_ref != step.operation_ref:
            raise program.error(same_id(step, other, "operation"), step.ref, "its_id")
        bounds.setdefault(step.id, replace(found, least=least))
    return bounds


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
