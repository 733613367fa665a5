"""Feeds along the path of a part as STEP-NC and as our own NC code, by workingstep.

``python -m benchmarks.both_ways`` optimises samples, writes them as NC code, and plans it
with the same tools and stock. Roughness and tolerance are told for each workingstep, as a user
of code tells them for a tool. Times are those of the moves whose feeds are chosen; column
``code/step`` is their time as code over that as STEP-NC.
"""

import argparse
import re
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import pi
from pathlib import Path

from optimiser.advice import Advice, AdviceStatus
from optimiser.along_path.bounds import bounds_of
from optimiser.along_path.caps import CutBounds
from optimiser.along_path.tool_bounds import KnownOfJob, bounds_of_tool
from service.along_path.course import Part, PathSource
from service.along_path.program_feeds import along_program
from service.along_path.run import FeedsAlongPath, along_path
from service.along_path.task import task_of
from service.programs.reading import read_program
from service.programs.toolpaths import paths_of
from service.requests.advice import AdviceRequest
from service.simulation.code_paths import CodeBlocks, CodePaths
from service.verbs.optimise.plan_result import ProgramAdvice
from service.verbs.optimise.program import advise_program as optimise
from service.verbs.optimise.request import AdviceFiles
from simulator.removal.cutter import THREADS, Cutter, Insert, shape_of
from simulator.spec import CuttingMaterial
from simulator.tool_kind import edge_material, tool_kind
from simulator.tools.tool_table import TableTool
from stepnc_model.nc.program import read_program as read_code
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.neutral import tool_numbers
from stepnc_model.programs.program import Program, Stock
from stepnc_model.programs.tool import tool_of
from stepnc_model.toolpath.task import stock_of

PARTS = Path(__file__).parents[1] / "examples" / "parts"
SAMPLES = ("bracket", "paper002", "paper003_pocket", "shaft")
REQUEST = AdviceRequest(nc_control=Dialect.LINUXCNC)


@dataclass(frozen=True, slots=True, kw_only=True)
class BothWays:
    """One workingstep as STEP-NC and as NC code."""

    name: str
    programmed: float
    """Time of its moves at one feed, s."""
    step: float
    """Their time along the path as STEP-NC, s."""
    code: float
    """Their time along the path as NC code, s."""

    @property
    def ratio(self) -> float:
        """Time as NC code over time as STEP-NC."""
        return self.code / self.step


def both_ways(part: str) -> Iterator[BothWays]:
    """Yield the workingsteps of a sample whose feeds are chosen.

    Parameters
    ----------
    part : str
        Name of a sample.
    """
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "one.stpnc"
        result = optimise(REQUEST, AdviceFiles(file=PARTS / f"{part}.stpnc", output=output))
        program = read_program(output, units="iso")
        text = output.with_suffix(".ngc").read_text()
    steps = along_program(program, result.plan, REQUEST)
    chosen = {
        advice.workingstep.id: advice
        for advice in result.plan.advices
        if advice.status is AdviceStatus.ADVISED and bounds_of(advice) is not None
    }
    code = _along_code(text, program, result, chosen)
    found = {step.name: step.plan for step in code.steps}
    for step in steps.steps:
        plan, other = step.plan, found.get(step.name)
        if plan is not None and other is not None:
            yield BothWays(
                name=step.name,
                programmed=plan.programmed_time,
                step=plan.time,
                code=other.time,
            )


def _along_code(
    text: str, program: Program, result: ProgramAdvice, chosen: dict[str, Advice]
) -> FeedsAlongPath:
    """Feeds along the paths of NC code, by workingstep."""
    names = [advice.workingstep.id for advice in result.plan.advices]
    # Each workingstep gets a part of its own, by a comment as in code of CAM systems.
    for name in names:
        text = re.sub(rf"^\({re.escape(name)}\)$", "(ROUGH)", text, flags=re.MULTILINE)
    machine, material = result.plan.machine, result.plan.material
    tools = _tools(program)
    paths = CodePaths(
        read_code(text.encode("latin-1"), dialect=Dialect.LINUXCNC),
        machine,
        material,
        name="part",
        tools=tools,
        stock=_numbers(stock_of(program, program.workingsteps[0].setup)),
    )
    by_part = dict(zip((part.name for part in paths.parts), names, strict=False))

    def bounds(part: Part) -> CutBounds | None:
        advice = chosen.get(by_part.get(part.name, ""))
        if advice is None or advice.conditions is None:
            return None
        return told(tools[part.tool], advice, result)

    source = PathSource(
        prepare=paths.prepared,
        bounds=bounds,
        numbered=lambda run: CodeBlocks(run.blocks, paths),
    )
    along = along_path(source, task_of(REQUEST, machine))
    steps = (replace(each, name=by_part.get(each.name, each.name)) for each in along.steps)
    return replace(along, steps=tuple(steps))


def told(tool: TableTool, advice: Advice, result: ProgramAdvice) -> CutBounds | None:
    """Bounds of a tool whose roughness and tolerance are told, as for NC code."""
    at, cut, state = advice.conditions, advice.cut, advice.after
    if at is None or cut is None or state is None:
        return None
    found = bounds_of_tool(
        tool,
        result.plan.machine,
        result.plan.material.material,
        quantile=REQUEST.safety,
        is_finishing=at.roughness is not None,
        roughness=at.roughness,
        job=KnownOfJob(
            finishing_speed=pi * cut.diameter * state.setting.speed, is_dry=at.is_dry
        ),
    )
    if found is None:
        return None
    return replace(found, at=replace(found.at, deflection=at.deflection))


def _tools(program: Program) -> dict[int, TableTool]:
    """Tool table of a program."""
    found = {}
    for ref, number in tool_numbers(paths_of(program).paths).items():
        tool, shape = tool_of(program, ref), shape_of(program, ref)
        kind = tool_kind(tool)
        if shape is None or kind in THREADS:
            continue
        if isinstance(shape, Cutter):
            # The length of a whole tool in its holder, which is no overhang.
            shape = replace(shape, holder=None)
        found[number] = TableTool(
            number=number,
            id=tool.id,
            kind=kind,
            cutting_material=edge_material(tool.edge_material) or CuttingMaterial.CARBIDE,
            teeth=tool.teeth,
            shape=shape,
            centre_cutting=tool.centre_cutting,
            max_depth=tool.cutting_edge_length if isinstance(shape, Insert) else None,
        )
    return found


def _numbers(stock: Stock | None) -> str:
    """Stock as the option ``--stock`` states it."""
    if stock is None:
        raise RuntimeError("the samples state their stock")
    if stock.radius is not None:
        numbers: tuple[float, ...] = (2.0 * stock.radius, stock.low[2], stock.high[2])
    else:
        numbers = (*stock.low, *stock.high)
    return ",".join(f"{number:g}" for number in numbers)


def main(arguments: Sequence[str] | None = None) -> None:
    """Print both ways of each sample."""
    argparse.ArgumentParser(description=__doc__).parse_args(arguments)
    for part in SAMPLES:
        print(part)
        print(
            f"  {'workingstep':20s} {'one feed s':>10s} {'step s':>8s} {'code s':>8s} code/step"
        )
        for row in both_ways(part):
            print(
                f"  {row.name:20s} {row.programmed:10.2f} {row.step:8.2f} {row.code:8.2f} "
                f"{row.ratio:9.3f}"
            )


if __name__ == "__main__":
    main()
