"""Triangles of B-rep solids, made by Open CASCADE in a process of its own.

Open CASCADE may crash on a damaged file, and a small file may keep it busy or fill the memory:
the process has limits of time and memory, and its end is an error of the file. Units mm.
"""

import json
import os
import signal
import subprocess
import sys
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from service.optional_packages import has_package, how_to_install
from service.processes.process_limits import ProcessLimits, limit_process
from simulator.motion.segments import Floats, Ints
from stepnc_model.errors import StepNcError

LONGEST = 120.0
"""Time limit, s."""

MOST_MEMORY = 6 << 30
"""Limit of the address space, bytes; the libraries alone take about one GB of it."""

MOST_TRIANGLES = 200_000

MOST_SOLIDS = 1000
"""Most solids of a file, each of which is measured."""

LARGEST = 1e5
"""Greatest extent of a solid, mm."""

WIDEST = 0.3
"""Greatest angle between neighbouring facets of a curved surface, rad."""

ALL = 0
"""Number that stands for all roots of the file."""

ARRAYS = ("number", "volume", "area", "low", "high", "triangles")
"""Arrays that the process hands over."""

REFUSED = 3
"""Exit code of the process if it ends with an error of the file."""

SAME = 1e-5
"""Distance at which corners are the same, mm."""

LAST_WORDS = 300
"""Most characters of what Open CASCADE says in an error."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Tessellation:
    """Solids of a file, and the triangles of one of them."""

    number: Ints
    """Number of each solid's instance in the file, from 1; 0: not known, (S,)."""
    volume: Floats
    """Exact volume, (S,), mm³."""
    area: Floats
    """Exact area, (S,), mm²."""
    low: Floats
    """Least coordinates, (S, 3), mm."""
    high: Floats
    """Greatest coordinates, (S, 3), mm."""
    shells: int
    """Shells that belong to no solid."""
    chosen: int
    """Row of the chosen solid; -1: none or several would be."""
    triangles: Floats
    """Its triangles, counter-clockwise from outside, (T, 3, 3), mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Choice:
    """Selection from a file: what is read and which solid is tessellated.

    Numbers count the instances of the file from 1.
    """

    root: int = ALL
    """Number of the instance that is read; by default all products."""
    solids: tuple[int, ...] = ()
    """Numbers of the instances that may be solids."""
    wanted: tuple[int, ...] = ()
    """Numbers of which the solid has one; without any, the only solid is chosen."""
    place: int = 0
    """Place among the solids that were read, from 1; 0: by its number."""


def require_open_cascade(name: str) -> None:
    """Refuse B-rep if Open CASCADE is not installed.

    Raises
    ------
    StepNcError
        With the command that installs it.
    """
    if not has_package("OCP"):
        raise StepNcError(
            f"{name}: B-rep solids are read by Open CASCADE, which is not installed: "
            f"{how_to_install('OCP')}"
        )


def tessellate(
    data: bytes,
    *,
    name: str,
    sag: float,
    choice: Choice,
    longest: float = LONGEST,
) -> Tessellation:
    """Find the solids of a STEP file, and tessellate the chosen one.

    Parameters
    ----------
    data : bytes
    name : str
        Name of the file in messages.
    sag : float, mm
        Greatest distance of triangles from the surface.
    longest : float, s
        Time limit.

    Raises
    ------
    StepNcError
        When Open CASCADE is not installed, cannot read the file, crashes or exceeds a limit,
        or the solid needs too many triangles.
    """
    require_open_cascade(name)
    with TemporaryDirectory() as folder:
        place, kept = Path(folder) / "part.step", Path(folder) / "part.npz"
        place.write_bytes(data)
        words = json.dumps({
            "file": str(place), "kept": str(kept), "sag": sag, "longest": longest,
            "most_memory": MOST_MEMORY, "most_solids": MOST_SOLIDS, **asdict(choice),
        })  # fmt: skip
        _run([sys.executable, "-m", "extras.brep.tessellation", words], name, longest)
        with np.load(kept, allow_pickle=False) as found:
            count = int(found["count"])
            if count > MOST_TRIANGLES:
                raise StepNcError(
                    f"{name}: the solid needs {count} triangles that lie within {sag:g} mm of "
                    f"it; at most {MOST_TRIANGLES} are accepted: allow a greater tolerance"
                )
            return Tessellation(
                **{key: found[key] for key in ARRAYS},
                shells=int(found["shells"]),
                chosen=int(found["chosen"]),
            )


def _run(words: list[str], name: str, longest: float) -> None:
    """Run the process, and raise its failure as an error of the file."""
    try:
        done = subprocess.run(words, capture_output=True, timeout=longest, check=False)
    except subprocess.TimeoutExpired:
        raise StepNcError(
            f"{name}: Open CASCADE takes longer than {longest:g} s, the limit for a part"
        ) from None
    if done.returncode == -signal.SIGXCPU:
        raise StepNcError(
            f"{name}: Open CASCADE takes longer than {longest:g} s, the limit for a part"
        )
    if done.returncode < 0:
        reason = signal.Signals(-done.returncode).name
        raise StepNcError(
            f"{name}: Open CASCADE crashes on this file ({reason}): it is damaged, or needs "
            f"more than {MOST_MEMORY / (1 << 30):.2g} GB"
        )
    if done.returncode == REFUSED:
        raise StepNcError(f"{name}: {done.stderr.decode(errors='replace').strip()}")
    if done.returncode:
        said = done.stderr.decode(errors="replace").strip().rpartition("\n")[2]
        raise StepNcError(f"{name}: Open CASCADE fails: {said[:LAST_WORDS]}")


def main() -> int:
    """Read the file that the command line names, within the limits; return the exit code."""
    words = json.loads(sys.argv[1])
    seconds = int(words["longest"]) + 1
    limit_process(ProcessLimits(memory=words["most_memory"], processor=seconds))
    # Open CASCADE tells its progress there.
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    try:
        return _keep(words)
    except StepNcError as error:
        sys.stderr.write(str(error))
        return REFUSED


def _keep(words: dict[str, Any]) -> int:
    """Tessellate and write what was found; return the exit code."""
    choice = Choice(**{each.name: words[each.name] for each in fields(Choice)})
    np.savez(words["kept"], **_tessellated(words, choice))
    return 0


def _tessellated(words: dict[str, Any], choice: Choice) -> dict[str, Any]:
    """Arrays of :class:`Tessellation`, and the count of triangles."""
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.TopAbs import TopAbs_ShapeEnum

    reader, most = _reader(words["file"]), words["most_solids"]
    shape = _shape(reader, (choice.root,))
    if choice.root == ALL and shape.NbChildren() == 0:
        # A file without products.
        shape = _shape(reader, choice.solids)
    solids = _within(shape, TopAbs_ShapeEnum.TopAbs_SOLID)
    if len(solids) > most:
        raise StepNcError(f"{len(solids)} solids; at most {most} are accepted")
    number = _numbers(reader, solids, choice.solids)
    if choice.place:
        rows = [choice.place - 1] if choice.place <= len(solids) else []
    else:
        rows = [
            row for row, each in enumerate(number) if not choice.wanted or each in choice.wanted
        ]
    sizes = np.array([_size(solid) for solid in solids]).reshape(-1, 8)
    triangles, count = np.zeros((0, 3, 3)), 0
    if len(rows) == 1:
        solid = solids[rows[0]]
        _require_small(sizes[rows[0]])
        BRepMesh_IncrementalMesh(solid, words["sag"], False, WIDEST, False)
        triangles, count = _triangles(solid)
    shell, within = TopAbs_ShapeEnum.TopAbs_SHELL, TopAbs_ShapeEnum.TopAbs_SOLID
    return {
        "number": np.array(number, dtype=np.int64), "volume": sizes[:, 0], "area": sizes[:, 1],
        "low": sizes[:, 2:5], "high": sizes[:, 5:], "triangles": triangles, "count": count,
        "chosen": rows[0] if len(rows) == 1 else -1,
        "shells": len(_within(shape, shell, outside=within)),
    }  # fmt: skip


def _require_small(size: Floats) -> None:
    """Refuse a solid whose triangles would take hours: its unit is usually wrong."""
    span = float((size[5:] - size[2:5]).max())
    if not span <= LARGEST:
        raise StepNcError(
            f"the solid spans {span:.6g} mm; at most {LARGEST:g} mm are accepted: is its unit "
            "right?"
        )


def _reader(file: str) -> Any:
    """Reader of a file; it converts lengths to mm."""
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.STEPControl import STEPControl_Reader

    reader = STEPControl_Reader()
    if reader.ReadFile(file) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise StepNcError("Open CASCADE finds no STEP instances")
    return reader


def _shape(reader: Any, roots: tuple[int, ...]) -> Any:
    """Shape of instances or of all products; an empty one where there is none."""
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Compound

    reader.ClearShapes()
    for root in roots:
        if root == ALL:
            reader.TransferRoots()
        else:
            reader.TransferOne(root)
    if reader.NbShapes():
        return reader.OneShape()
    nothing = TopoDS_Compound()
    BRep_Builder().MakeCompound(nothing)
    return nothing


def _numbers(reader: Any, solids: list[Any], candidates: tuple[int, ...]) -> list[int]:
    """Number of the instance of each solid; 0: not known."""
    number = [0] * len(solids)
    for each in candidates:
        shape = _shape(reader, (each,))
        for row, solid in enumerate(solids):
            if solid.IsPartner(shape):
                number[row] = each
    return number


def _within(shape: Any, kind: Any, *, outside: Any = None) -> list[Any]:
    """Shapes of a kind within a shape, but for those that belong to another kind."""
    from OCP.TopExp import TopExp_Explorer

    explorer = TopExp_Explorer(shape, kind)
    if outside is not None:
        explorer = TopExp_Explorer(shape, kind, outside)
    found = []
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found


def _size(solid: Any) -> tuple[float, ...]:
    """Volume, area and box of a solid."""
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    volume, area, box = GProp_GProps(), GProp_GProps(), Bnd_Box()
    BRepGProp.VolumeProperties_s(solid, volume)
    BRepGProp.SurfaceProperties_s(solid, area)
    BRepBndLib.AddOptimal_s(solid, box, False, False)
    if box.IsVoid():
        return (volume.Mass(), area.Mass(), *(0.0,) * 6)
    ends = (box.CornerMin(), box.CornerMax())
    bounds = (each for end in ends for each in (end.X(), end.Y(), end.Z()))
    return (volume.Mass(), area.Mass(), *bounds)


def _triangles(solid: Any) -> tuple[Floats, int]:
    """Triangles of a meshed solid, and their count; none if there are too many."""
    from OCP.BRep import BRep_Tool
    from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS

    found, count = [np.zeros((0, 3, 3))], 0
    for shape in _within(solid, TopAbs_ShapeEnum.TopAbs_FACE):
        location = TopLoc_Location()
        face = TopoDS.Face(shape)
        mesh = BRep_Tool.Triangulation_s(face, location)
        if mesh is None:
            raise StepNcError("a face gets no triangles: is its surface damaged?")
        count += mesh.NbTriangles()
        if count > MOST_TRIANGLES:
            continue
        way = location.Transformation()
        points = [mesh.Node(row + 1).Transformed(way) for row in range(mesh.NbNodes())]
        nodes = np.array([(each.X(), each.Y(), each.Z()) for each in points])
        corners = np.array([mesh.Triangle(row + 1).Get() for row in range(mesh.NbTriangles())])
        if shape.Orientation() == TopAbs_Orientation.TopAbs_REVERSED:
            corners = corners[:, ::-1]
        found.append(_with_area(nodes[corners - 1]))
    return (np.concatenate(found) if count <= MOST_TRIANGLES else found[0]), count


def _with_area(triangles: Floats) -> Floats:
    """Triangles without those of which two corners meet, as at poles and tips of cones."""
    ends = triangles[:, [1, 2, 0]]
    return np.asarray(triangles[(np.abs(ends - triangles).max(axis=2) > SAME).all(axis=1)])


if __name__ == "__main__":
    sys.exit(main())
