"""Machines, work materials and tool grades by name or from the user's own files.

The files are in ``simulator/data``, one per machine, material and kind of tool, with the unit
in each key and a source in each table. A value that is missing, misspelt or out of range raises
a :class:`simulator.errors.LibraryError` that names file, key, value and bound.
"""

from difflib import get_close_matches
from functools import cache
from pathlib import Path

from simulator.errors import LibraryError, UnknownMachine, UnknownMaterial
from simulator.grade_file import ANY_GROUP, read_allowances, read_grades, read_tools
from simulator.machine_file import read_machine
from simulator.machine_xml import read_machine_xml
from simulator.material_file import read_material
from simulator.spec import (
    CuttingMaterial,
    CuttingWindow,
    Machine,
    ReamingAllowance,
    ToolConstruction,
    ToolGrade,
    ToolKind,
    WorkMaterial,
)

DATA = Path(__file__).with_name("data")
"""Folder with the files of the library."""

SOLID_TOOLS = frozenset({
    ToolKind.ENDMILL,
    ToolKind.DRILL,
    ToolKind.CENTER_DRILL,
    ToolKind.COUNTERSINK,
    ToolKind.REAMER,
    ToolKind.TAP,
})
"""Kinds of tools whose edges are part of a solid body; all others hold inserts."""


def machine_names() -> tuple[str, ...]:
    """Names of the machines in the library."""
    return _names("machines")


def material_names() -> tuple[str, ...]:
    """Names of the work materials in the library."""
    return _names("materials")


def material_path(name: str) -> Path:
    """Path of the file of a material in the library."""
    return DATA / "materials" / f"{name}.toml"


def load_machine(name_or_path: str) -> Machine:
    """Load a machine from the library or from the user's own file.

    Parameters
    ----------
    name_or_path : str
        ``vmc15``, or a file ``my.toml``, or a file ``my.xml`` in the format of
        :mod:`simulator.machine_xml`.

    Raises
    ------
    UnknownMachine
        If the library has no machine of that name.
    LibraryError
        If the file cannot be read or a value in it is invalid.

    Examples
    --------
    >>> load_machine("paper002").spindle.efficiency
    0.9
    """
    path = Path(name_or_path)
    if path.suffix.lower() == ".xml":
        return read_machine_xml(path)
    if _is_path(name_or_path):
        return read_machine(path)
    name = name_or_path.strip().lower()
    if name not in machine_names():
        raise UnknownMachine(name_or_path, _nearest_first(name, machine_names()))
    return read_machine(DATA / "machines" / f"{name}.toml")


def load_material(name_or_path: str) -> WorkMaterial:
    """Load a work material from the library or from the user's own file.

    Parameters
    ----------
    name_or_path : str
        ``c45``, or a file ``my.toml``. For catalogue names, standard numbers and texts of
        STEP-NC programs use :func:`simulator.matching.match_material`.

    Raises
    ------
    UnknownMaterial
        If the library has no material of that name.
    LibraryError
        If the file cannot be read or a value in it is invalid.

    Examples
    --------
    >>> load_material("paper002").kienzle
    Kienzle(k_c11=1000.0, m_c=0.0, rake_angle=None)
    """
    if _is_path(name_or_path):
        return read_material(Path(name_or_path))
    name = name_or_path.strip().lower()
    if name not in material_names():
        raise UnknownMaterial(name_or_path, _nearest_first(name, material_names()))
    return read_material(material_path(name))


def find_window(
    material: WorkMaterial, tool_kind: ToolKind, cutting_material: CuttingMaterial
) -> CuttingWindow | None:
    """Cutting-speed window of a tool in a material; ``None`` if the source gives none.

    Carbide has two windows in most materials, for solid tools and for inserts. If the source
    gives only one of them, it is used for both.
    """
    body = ToolConstruction.SOLID if tool_kind in SOLID_TOOLS else ToolConstruction.INDEXABLE
    windows = [
        window for window in material.windows if window.cutting_material is cutting_material
    ]
    fitting = [window for window in windows if window.tool_body in {body, None}]
    return next(iter(fitting or windows), None)


def find_grade(
    tool_kind: ToolKind, cutting_material: CuttingMaterial, iso_group: str
) -> ToolGrade:
    """Grade of a kind of tool for an ISO group, or else the grade for all groups.

    Parameters
    ----------
    tool_kind : ToolKind
    cutting_material : CuttingMaterial
    iso_group : str
        P, M, K, N, S or H.

    Raises
    ------
    LibraryError
        If the library has no such grade, for example HSS in hardened steel.
    """
    grades = [
        grade for grade in _grades(tool_kind) if grade.cutting_material is cutting_material
    ]
    for group in (iso_group, ANY_GROUP):
        for grade in grades:
            if grade.iso_group == group:
                return grade
    raise LibraryError(
        f"no {cutting_material} grade for ISO group '{iso_group}'",
        path=str(_grade_path(tool_kind)),
    )


def bare_tool(tool_kind: ToolKind, cutting_material: CuttingMaterial) -> ToolGrade | None:
    """Stiffness, strength and geometry of a kind of tool, without windows; None if unknown."""
    tools = _tools(tool_kind)
    return next((each for each in tools if each.cutting_material is cutting_material), None)


@cache
def reaming_allowances() -> tuple[ReamingAllowance, ...]:
    """Allowances of reamers by diameter, the smallest first."""
    return read_allowances(_grade_path(ToolKind.REAMER))


@cache
def _tools(kind: ToolKind) -> tuple[ToolGrade, ...]:
    """Tools of one kind without windows, one of each cutting material."""
    return read_tools(_grade_path(kind), kind)


@cache
def _grades(kind: ToolKind) -> tuple[ToolGrade, ...]:
    """Grades of one kind of tool; cached, because they are needed for every workingstep."""
    return read_grades(_grade_path(kind), kind)


def _grade_path(kind: ToolKind) -> Path:
    """Path of the file with the grades of one kind of tool."""
    return DATA / "tools" / f"{kind}.toml"


def _names(folder: str) -> tuple[str, ...]:
    """Names of the TOML files, without suffix, in a folder of the library."""
    return tuple(sorted(path.stem for path in (DATA / folder).glob("*.toml")))


def _is_path(name_or_path: str) -> bool:
    """Whether the user gave a path rather than a name."""
    return name_or_path.lower().endswith(".toml") or "/" in name_or_path or "\\" in name_or_path


def _nearest_first(name: str, known: tuple[str, ...]) -> tuple[str, ...]:
    """Known names, with those similar to ``name`` first."""
    near = get_close_matches(name, known, n=5, cutoff=0.4)
    return (*near, *(other for other in known if other not in near))
