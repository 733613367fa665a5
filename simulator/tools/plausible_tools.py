"""Tools that one may be of which neither a table nor a comment says everything.

Limits that hold for each of them hold for the tool in the spindle. Teeth: few make the chip
thick, many the force great. Edges of high-speed steel: their shank bends three times as far,
and their windows are lower; a programmed cutting speed that no such edge stands rules them out.
Overhang: one that is longer than the customary 3 D.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import inf, isinf, pi

from simulator.removal.cutter import Cutter
from simulator.spec import CuttingMaterial, ToolKind, WorkMaterial
from simulator.tools.tool_table import TableTool, grade_for
from simulator.tools.usual_teeth import usual_teeth

LONG = 4.0
"""Greatest overhang of a mill over its diameter that counts as usual; long series of DIN 6527
reach out by 3 to 4 D."""

COATED = 2.0
"""Cutting speed up to which high-speed steel is plausible, over that of the catalogue for
drills of it: coated edges with cobalt, and people who take a risk."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolGuess:
    """Properties of a tool that nothing states."""

    has_kind: bool = False
    """Whether the kind is guessed: a size alone is taken for that of an end mill."""
    has_teeth: bool = False
    """Whether the number of teeth is guessed."""
    has_edge: bool = False
    """Whether the cutting material is guessed."""
    has_length: bool = True
    """Whether nothing tells how far the tool reaches out."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolUse:
    """Use of a tool in a program."""

    speed: float = 0.0
    """Greatest spindle speed, rev/s; 0 if it is not known."""
    depth: float = 0.0
    """Greatest depth under the top of the stock to which it goes, mm."""


def plausible_tools(
    tool: TableTool, guess: ToolGuess, use: ToolUse, material: WorkMaterial
) -> tuple[TableTool, ...]:
    """Tools that a tool may be, the one with the fewest teeth first.

    Parameters
    ----------
    tool : TableTool
        The tool with its guessed values.
    """
    shape = tool.shape
    if not isinstance(shape, Cutter):
        return (tool,)
    teeth: tuple[int, ...] = (tool.teeth,)
    if guess.has_teeth:
        usual = usual_teeth(tool.kind, shape.diameter, iso_group=material.iso_group)
        teeth = (usual.least, usual.usual, usual.most)
    found = [
        replace(tool, cutting_material=edge, teeth=count, shape=replace(body, teeth=count))
        for edge in _edges(tool, shape, guess, use, material)
        for body in _bodies(shape, guess, use)
        for count in teeth
    ]
    return tuple(dict.fromkeys(found))


def _edges(
    tool: TableTool, shape: Cutter, guess: ToolGuess, use: ToolUse, material: WorkMaterial
) -> Iterator[CuttingMaterial]:
    """Cutting materials that a tool may have."""
    yield tool.cutting_material
    if not guess.has_edge or tool.cutting_material is CuttingMaterial.HSS:
        return
    drill = grade_for(ToolKind.DRILL, CuttingMaterial.HSS, material)
    most = inf if drill is None or drill.max_cutting_speed is None else drill.max_cutting_speed
    if pi * shape.diameter * use.speed <= COATED * most:
        yield CuttingMaterial.HSS


def _bodies(shape: Cutter, guess: ToolGuess, use: ToolUse) -> Iterator[Cutter]:
    """Shapes with the overhangs that are usual for the depth."""
    is_open = isinf(shape.edge_length) and shape.overhang is None
    if guess.has_length and is_open and not shape.is_drill:
        yield replace(shape, edge_length=max(LONG * shape.diameter, use.depth))
    yield shape
