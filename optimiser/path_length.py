"""Length of an explicit tool path, by the corner points of its curves."""

from itertools import pairwise
from math import dist

from optimiser.outline import points_of
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.toolpaths import CutterLocationTrajectory, ToolpathList
from stepnc_model.errors import SchemaError
from stepnc_model.part21.values import Ref
from stepnc_model.program import Program


def path_length(program: Program, ref: Ref[ToolpathList]) -> float:
    """Length in mm of the trajectories of a list that are not run at rapid.

    Curves of a kind that cannot be measured count nothing; 0 when there is no other.
    """
    return sum(_length(program, path) for path in program.get(ref).its_list)


def _length(program: Program, ref: Ref[Entity]) -> float:
    path = program.model.entity(int(ref))
    if not isinstance(path, CutterLocationTrajectory) or str(path.its_speed) == "RAPID":
        return 0.0
    try:
        points = list(points_of(program, path.basiccurve))
    except SchemaError:
        return 0.0
    return sum(dist(one, other) for one, other in pairwise(points))
