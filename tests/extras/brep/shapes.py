"""B-rep of parts, made and written by Open CASCADE.

It takes a second to load, which only those tests wait for that make a part.
"""

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

Spot = tuple[float, float, float]


def block(low: Spot, high: Spot) -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Pnt

    return BRepPrimAPI_MakeBox(gp_Pnt(*low), gp_Pnt(*high)).Shape()


def bore(at: Spot, *, radius: float, depth: float) -> Any:
    """An upright cylinder that ends below a point."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    x, y, z = at
    axis = gp_Ax2(gp_Pnt(x, y, z - depth), gp_Dir(0.0, 0.0, 1.0))
    return BRepPrimAPI_MakeCylinder(axis, radius, depth).Shape()


def torus(great: float, small: float) -> Any:
    """Ring around Z, by its two radii in mm."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeTorus

    return BRepPrimAPI_MakeTorus(great, small).Shape()


def without(whole: Any, *parts: Any) -> Any:
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut

    for part in parts:
        whole = BRepAlgoAPI_Cut(whole, part).Shape()
    return whole


def first_face(shape: Any) -> Any:
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer

    return TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_FACE).Current()


def rounded(low: Spot, high: Spot, radius: float) -> Any:
    """A block whose upright edges are rounded."""
    from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp, TopExp_Explorer
    from OCP.TopoDS import TopoDS

    shape = block(low, high)
    made = BRepFilletAPI_MakeFillet(shape)
    explorer = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_EDGE)
    while explorer.More():
        edge = TopoDS.Edge(explorer.Current())
        one, other = _point(TopExp.FirstVertex_s(edge)), _point(TopExp.LastVertex_s(edge))
        if abs(one[2] - other[2]) > 1e-6:
            made.Add(radius, edge)
        explorer.Next()
    return made.Shape()


def revolved(profile: Sequence[tuple[float, float]]) -> Any:
    """Body of revolution about Z through points z and r."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakePolygon
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeRevol
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt

    outline = BRepBuilderAPI_MakePolygon()
    for z, r in profile:
        outline.Add(gp_Pnt(r, 0.0, z))
    outline.Close()
    face = BRepBuilderAPI_MakeFace(outline.Wire()).Face()
    axis = gp_Ax1(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0))
    return BRepPrimAPI_MakeRevol(face, axis).Shape()


def write_step(
    path: Path, *shapes: Any, schema: str = "AP214IS", unit: str = "MM", name: str = "PART"
) -> Path:
    """Write shapes as products of a STEP file."""
    from OCP.Interface import Interface_Static
    from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer

    with _silence():
        writer = STEPControl_Writer()
        assert Interface_Static.SetCVal_s("write.step.schema", schema)
        assert Interface_Static.SetCVal_s("write.step.unit", unit)
        assert Interface_Static.SetCVal_s("write.step.product.name", name)
        # The model takes its schema and unit when it is made.
        writer = STEPControl_Writer()
        for shape in shapes:
            writer.Transfer(shape, STEPControl_StepModelType.STEPControl_AsIs)
        writer.Write(str(path))
    return path


def _point(vertex: Any) -> Spot:
    from OCP.BRep import BRep_Tool

    point = BRep_Tool.Pnt_s(vertex)
    return point.X(), point.Y(), point.Z()


@contextmanager
def _silence() -> Iterator[None]:
    """Without what Open CASCADE prints."""
    kept, null = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(null)
