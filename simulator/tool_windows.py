"""Windows of feed, speed and depth of a tool in a work material.

Where no source gives windows for the ISO group of the material, those of the nearest group that
is harder to cut take their place: its feeds, speeds and depths are smaller. A material that
names no group is taken as the hardest to cut of the groups that its data do not exclude. So a
material of which little is known gets the smallest windows.

References
----------
.. [1] ISO 513: group H is hardened steel and chilled cast iron.
.. [2] ISO 4957: high-speed steels have 64 to 67 HRC after hardening and tempering.
"""

from dataclasses import replace
from functools import cache
from math import inf

from simulator.errors import LibraryError
from simulator.library import bare_tool, find_grade, load_material, material_names
from simulator.spec import CuttingMaterial, ToolGrade, ToolKind, WorkMaterial

GROUPS = "NKPMSH"
"""ISO groups, the easiest to cut first: in this order feeds and depths of the library fall."""

HARD = "H"
"""Group of hardened steel and chilled iron: nothing is too hard for it."""

BEYOND = 1.2
"""Factor by which a value may lie beyond those of the library's materials of a group: the
spread of k_c between catalogues."""

DENSITY_BEYOND = 1.05
"""The same factor for the density, which depends on the alloy alone."""

CHIP = 0.1
"""Chip thickness at which specific cutting forces are compared, mm."""


def grade_for(
    tool_kind: ToolKind, cutting_material: CuttingMaterial, material: WorkMaterial
) -> ToolGrade | None:
    """Tool for a material: with its own windows, else the nearest on the safe side, else none.

    Returns
    -------
    ToolGrade or None
        None if the library has no such tool. Borrowed windows say so; a tool without windows
        has no greatest feed.
    """
    groups = possible_groups(material)
    hardest = groups[-1]
    for group in GROUPS[GROUPS.index(hardest) :]:
        grade = _grade(tool_kind, cutting_material, group)
        if grade is not None:
            return replace(grade, borrowed=_why(grade, material, group))
    easier = reversed(groups[:-1])
    for grade in (_grade(tool_kind, cutting_material, group) for group in easier):
        if grade is not None:
            return replace(grade, borrowed=_why(grade, material, grade.iso_group))
    return bare_tool(tool_kind, cutting_material)


def _grade(
    tool_kind: ToolKind, cutting_material: CuttingMaterial, group: str
) -> ToolGrade | None:
    """Grade of a kind of tool for one ISO group; None if there is none."""
    try:
        return find_grade(tool_kind, cutting_material, group)
    except LibraryError:
        return None


def _why(grade: ToolGrade, material: WorkMaterial, group: str) -> str:
    """Reason why windows of a group are used; empty if it is that of the material."""
    if material.iso_group == group:
        return ""
    if material.iso_group:
        return (
            f"the windows of ISO group {group}, the nearest that is harder to cut: no source "
            f"gives {grade.cutting_material} in group {material.iso_group}"
        )
    groups = possible_groups(material)
    of = f"the hardest to cut of {', '.join(groups)}" if len(groups) > 1 else "as its data say"
    return f"the windows of ISO group {group}, {of}: material '{material.name}' names no group"


def why_unsuited(cutting_material: CuttingMaterial, material: WorkMaterial) -> str:
    """Reason why an edge cannot cut a material at all; empty if it can.

    High-speed steel is hardly harder than group H [1]_, [2]_.
    """
    if cutting_material is not CuttingMaterial.HSS or possible_groups(material) != (HARD,):
        return ""
    return (
        f"high-speed steel (64 to 67 HRC) does not cut {material.title}, ISO group H: use "
        "carbide, ceramic or CBN"
    )


def possible_groups(material: WorkMaterial) -> tuple[str, ...]:
    """ISO groups that a material may belong to, the easiest to cut first.

    That of its file, else those that hardness, strength, density and specific cutting force do
    not exclude; all if no group fits.
    """
    if material.iso_group:
        return (material.iso_group,)
    values = _values(material)
    fitting = tuple(group for group in GROUPS if _fits(group, values))
    return fitting or tuple(GROUPS)


def _fits(group: str, values: tuple[float | None, ...]) -> bool:
    """Whether no known value lies beyond those of the group."""
    ranges = _ranges()[group]
    return all(
        value is None or low <= value <= high
        for value, (low, high) in zip(values, ranges, strict=True)
    )


def _values(material: WorkMaterial) -> tuple[float | None, ...]:
    """Hardness, tensile strength, density and specific cutting force of a material."""
    law = material.kienzle
    force = law.k_c11 * CHIP**-law.m_c
    return material.hardness_hb, material.tensile_strength, material.density, force


@cache
def _ranges() -> dict[str, tuple[tuple[float, float], ...]]:
    """Ranges of the values of each group, from the materials of the library."""
    known: dict[str, list[tuple[float | None, ...]]] = {group: [] for group in GROUPS}
    for name in material_names():
        material = load_material(name)
        if material.iso_group:
            known[material.iso_group].append(_values(material))
    return {
        group: tuple(
            _range(column, group, place) for place, column in enumerate(zip(*rows, strict=True))
        )
        for group, rows in known.items()
    }


def _range(column: tuple[float | None, ...], group: str, place: int) -> tuple[float, float]:
    """Least and greatest value of a property in a group, widened; unbounded if unknown."""
    values = [value for value in column if value is not None]
    if not values:
        return 0.0, inf
    beyond = DENSITY_BEYOND if place == 2 else BEYOND
    high = inf if group == HARD and place != 2 else beyond * max(values)
    return min(values) / beyond, high
