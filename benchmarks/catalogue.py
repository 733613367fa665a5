"""Advice beside catalogue windows, for every material, cutting material, kind of tool and size.

Each cut is half as wide as the tool, where catalogue feeds hold as they are printed, and is
programmed gently. The windows are read from the TOML files again, apart from the product's
readers. Advice above the window of its ISO group must be marked: by a required limit that is
listed as unchecked, or as infeasible.
"""

import argparse
import random
import tomllib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cache
from math import inf, pi, radians
from typing import Any

from optimiser.bounds.required_limits import unchecked_limits
from optimiser.bounds.speed_limits import why_no_speed
from optimiser.cuts.conditions import CuttingConditions, tool_grade
from optimiser.cuts.cut import Cut, CutKind
from optimiser.errors import Infeasible
from optimiser.modes import Free, Mode
from optimiser.planning.formulate import OptimisationTask, problem_of, state_of
from optimiser.safety import safety_factor
from optimiser.solver import workingstep as exact
from optimiser.solver.problem import Setting
from simulator.library import DATA, load_machine, load_material, material_names
from simulator.physics.engagement import unidirectional
from simulator.spec import CuttingMaterial, ToolKind
from simulator.tools.tool_table import why_unsuited
from stepnc_model.programs.tool import Tool

DIAMETERS = (1.0, 12.0, 160.0)
"""Diameters of the tools, or of the bar that is turned, mm."""

KINDS = tuple(kind for kind in ToolKind if kind not in {ToolKind.TAP, ToolKind.THREADING})
"""Kinds of tools whose feed may be chosen."""

GENTLE = 0.5
"""Programmed feed per tooth over that of the window, where there is one."""

UNKNOWN_FEED = 0.01
"""Programmed feed per tooth over the diameter where no window is known."""

SLOW = 200.0
"""Programmed cutting speed, mm/s."""

SLACK = 1.0 + 1e-9


class Verdict(StrEnum):
    """Outcome of a case."""

    WITHIN = "within its catalogue windows"
    MARKED = "marked: a required limit is unchecked"
    INFEASIBLE = "infeasible, with the limits that contradict each other"
    IMPOSSIBLE = "impossible: no such tool, or it cannot cut the material"
    ABOVE = "ABOVE A WINDOW WITHOUT A MARK"


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A tool in a material."""

    material: str
    edge: CuttingMaterial
    kind: ToolKind
    diameter: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Window:
    """Greatest values of a catalogue for a case; infinite where it says nothing."""

    feed: float = inf
    """Feed per tooth of mills, else per revolution, mm."""
    depth: float = inf
    """Depth of a pass, mm."""
    speed: float = inf
    """Cutting speed, m/min."""


def every_case() -> Iterator[Case]:
    """Every material, cutting material, kind of tool and size."""
    for material in material_names():
        for edge in CuttingMaterial:
            for kind in KINDS:
                for diameter in DIAMETERS:
                    yield Case(material=material, edge=edge, kind=kind, diameter=diameter)


def verdict_of(case: Case) -> Verdict:
    """Advise a case, and compare the advice with the windows of its group."""
    material = load_material(case.material)
    machine = load_machine("lathe22" if case.kind in TURNED else "vmc15")
    grade = tool_grade(case.kind, case.edge, machine, material)
    if grade is None or why_unsuited(case.edge, material):
        return Verdict.IMPOSSIBLE
    at = CuttingConditions(
        machine=machine,
        material=material,
        cutting_material=case.edge,
        grade=grade,
        roughness=None,
        safety_factor=safety_factor(material.spread or 0.0, 0.9),
    )
    cut = _cut(case, at)
    if why_no_speed(cut, at):
        return Verdict.INFEASIBLE
    problem = problem_of(cut, at, OptimisationTask(free=frozenset(Free)))
    try:
        setting = exact.solve(problem, Mode.TC).setting
    except Infeasible:
        return Verdict.INFEASIBLE
    limits = tuple(load.limit for load in state_of(cut, problem, at, setting).loads)
    if unchecked_limits(cut, at, limits):
        return Verdict.MARKED
    return Verdict.WITHIN if _is_within(case, cut, setting) else Verdict.ABOVE


TURNED = {ToolKind.TURNING, ToolKind.GROOVING}
WIDENING = {ToolKind.BORING_BAR, ToolKind.COUNTERSINK}
MILLED = {ToolKind.ENDMILL, ToolKind.FACEMILL}


def _is_within(case: Case, cut: Cut, setting: Setting) -> bool:
    """True if a setting keeps the windows of the group of its material."""
    window = window_of(case)
    feed = setting.feed * (1 if case.kind in MILLED else cut.tool.teeth)
    depth = setting.depth if case.kind in MILLED | {ToolKind.TURNING} else 0.0
    speed = pi * cut.diameter * setting.speed * 0.06
    return (
        feed <= window.feed * SLACK
        and depth <= window.depth * SLACK
        and speed <= window.speed * SLACK
    )


def window_of(case: Case) -> Window:
    """Windows that the files print for the group of a material."""
    material = _read("materials", case.material)
    tools = _read("tools", case.kind)
    edge = tools["edge"].get(case.edge, {})
    size = min(
        case.diameter * edge.get("pilot", {}).get("ratio", 1.0),
        edge.get("sizes", {}).get("largest_diameter_mm", inf),
    )
    row: dict[str, Any] = next(
        (
            row
            for row in tools["grade"]
            if (row["cutting_material"], row["iso_group"]) == (case.edge, material["iso_group"])
        ),
        {},
    )
    feeds = [row.get("max_feed_mm", inf), row.get("max_feed_ratio", inf) * size]
    given = material.get("feed_per_tooth", {})
    feeds.append(given.get("max_mm", inf))
    if case.kind is ToolKind.ENDMILL and case.edge is CuttingMaterial.CARBIDE:
        feeds.append(given.get("max_ratio", inf) * size)
    depths = [row.get("max_depth_mm", inf), row.get("max_depth_ratio", inf) * size]
    speed = row.get("max_cutting_speed_m_min")
    if speed is None:
        speed = max(
            (
                each.get("max_cutting_speed_m_min", inf)
                for each in material.get("window", [])
                if each["cutting_material"] == case.edge
            ),
            default=inf,
        )
    return Window(feed=min(feeds), depth=min(depths), speed=speed)


@cache
def _read(folder: str, name: str) -> dict[str, Any]:
    """Content of a TOML file of the library."""
    return tomllib.loads((DATA / folder / f"{name}.toml").read_text(encoding="utf-8"))


def _cut(case: Case, at: CuttingConditions) -> Cut:
    """Cut half as wide as its tool, at half the feed of its window and a slow speed."""
    window, diameter = window_of(case), case.diameter
    is_mill, is_turned = case.kind in MILLED, case.kind in TURNED
    teeth = 1 if is_turned else 2
    feed = min(GENTLE * window.feed / (1 if is_mill else teeth), UNKNOWN_FEED * diameter)
    depth = min(0.1 * diameter, 0.5 * window.depth)
    tool = Tool(
        id="tool",
        keyword="",
        diameter=0.0 if is_turned else diameter,
        teeth=teeth,
        corner_radius=0.8 if case.kind is ToolKind.TURNING else None,
        width=3.0 if case.kind is ToolKind.GROOVING else None,
    )
    cut = Cut(
        kind=_kind(case.kind),
        tool=tool,
        tool_kind=case.kind,
        diameter=diameter,
        programmed=Setting(
            feed=feed, depth=depth, passes=4, speed=10_000.0 / 60 / diameter / pi
        ),
        length=10.0 * diameter,
        total_depth=4.0 * depth,
        is_depth_free=is_mill or case.kind is ToolKind.TURNING,
        corner_radius=tool.corner_radius or 0.0,
        radial_width=tool.width or 0.5 * diameter,
        previous_diameter=_previous(case),
        volume=1.0,
    )
    if not is_mill:
        return cut
    helix = at.grade.helix_angle if at.grade is not None else radians(30.0)
    return replace(cut, engagement=unidirectional(0.5 * diameter, diameter), helix_angle=helix)


def _previous(case: Case) -> float:
    """Diameter of the hole before a tool, mm."""
    if case.kind is ToolKind.REAMER:
        return case.diameter - (0.15 if case.diameter <= 5.0 else 0.25)
    return 0.9 * case.diameter if case.kind in WIDENING else 0.0


def _kind(kind: ToolKind) -> CutKind:
    """Process of a kind of tool."""
    if kind in MILLED:
        return CutKind.MILLING
    if kind is ToolKind.TURNING:
        return CutKind.TURNING
    return CutKind.GROOVING if kind is ToolKind.GROOVING else CutKind.DRILLING


def main(arguments: list[str] | None = None) -> None:
    """Print how many cases came to which end."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sample", type=int, default=0, help="number of cases; 0: all")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    cases = list(every_case())
    if options.sample:
        cases = random.Random(options.seed).sample(cases, options.sample)
    found = [(case, verdict_of(case)) for case in cases]
    counts = Counter(verdict for _, verdict in found)
    print(f"{len(cases)} cases: materials × cutting materials × kinds of tools × diameters")
    for verdict in Verdict:
        print(f"{counts[verdict]:6} {verdict}")
    for case, verdict in found:
        if verdict is Verdict.ABOVE:
            print(f"       {case}")


if __name__ == "__main__":
    main()
