"""Check of rewritten NC code: no block may be faster than its place permits.

The ends of split blocks are rounded to what the program can say, and the engagement is known
for stretches that depend on how the path is cut into blocks. So what is written is run as well,
and a block that is too fast is slowed down. Its path stays, so one run is enough.
"""

from collections.abc import Callable
from dataclasses import replace

from optimiser.along_path.plan import FeedTask
from service.along_path.course import PathSource
from service.along_path.plan_run import PartTotals, run_plan
from service.simulation.code_paths import CodePaths
from stepnc_model.nc.advice import BlockAdvice, RewrittenCode
from stepnc_model.nc.program import NcProgram, read_program
from stepnc_model.nc.rewrite import rewrite
from stepnc_model.post.block_feeds import BlockPart


def settled(
    rewritten: RewrittenCode,
    program: NcProgram,
    *,
    source_of: Callable[[CodePaths], PathSource],
    paths_of: Callable[[NcProgram], CodePaths],
    task: FeedTask,
    totals: PartTotals,
) -> RewrittenCode:
    """Rewritten code in which no block is too fast.

    Parameters
    ----------
    rewritten : RewrittenCode
    program : NcProgram
        Program that was rewritten.
    source_of, paths_of : callable
        Functions that prepare a program for runs.
    task : FeedTask
    totals : PartTotals
        Receives the run.

    Raises
    ------
    StepNcError
        When the machine cannot run the program.
    """
    again = read_program(rewritten.data, dialect=program.dialect, machine=program.machine)
    code = paths_of(again)
    run = run_plan(source_of(code), {}, task=task, splits=False, totals=totals)
    slower = (block_advice(code, line, each.parts) for (line, _), each in run.slower.items())
    return replace(rewritten, data=rewrite(again, slower).data)


def block_advice(code: CodePaths, line: int, parts: tuple[BlockPart, ...]) -> BlockAdvice:
    """Advice for a line of the file; feeds per revolution at its greatest speed."""
    block = code.block_at(line)
    fastest = code.fastest(block) if parts[0].is_per_revolution else 1.0
    reasons = dict.fromkeys(part.reason for part in parts)
    return BlockAdvice(
        block=block,
        ends=tuple(part.end for part in parts),
        feeds=tuple(part.rate * fastest for part in parts),
        reason=", ".join(reasons),
    )
