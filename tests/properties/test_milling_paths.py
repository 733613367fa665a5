"""Random milling workingsteps: no gouge, everything reached, no rapid through the stock.

The judge knows nothing of the code under test but its path: the material that must stay is a
polygon worked out from the drawn sizes, distances from it are taken by shapely.

The rule for rapids: sideways only above the stock, down no further than the retract plane,
and up.
"""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from math import cos, dist, radians, sin

import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import MultiLineString, Polygon, affinity
from shapely.geometry.base import BaseGeometry

from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.arc import points_along
from stepnc_model.toolpath.generate import workingstep_path
from stepnc_model.toolpath.path import MoveType, Point, ToolPath

SIDE, TOP, DEPTH, RETRACT, AXIAL = 100.0, 2.0, 6.0, 5.0, 2.5
"""mm: half of the stock, its top, the feature's depth below z = 0, its retract plane"""

FINE = 0.01
"""rad between points of an arc"""

COARSE = 0.05
"""rad, where areas are compared"""

CLOSE = 1.5e-3
"""mm; a tool as wide as its slot may be wider by a thousandth"""

PART = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('','',(''),(''),'','','');
FILE_SCHEMA(('MACHINING_SCHEMA'));
ENDSEC;
DATA;
#1=PROJECT('P',#2,(#3),$,$,$);
#2=WORKPLAN('W',(#4),$,#5,$);
#3=WORKPIECE('P',$,0.05,$,$,#6,());
#4=MACHINING_WORKINGSTEP('STEP',#7,#10,#20,$);
#5=SETUP('S',#90,#7,());
#6=BLOCK('',#8,200.,200.,42.);
#7=PLANE('',#9);
#8=AXIS2_PLACEMENT_3D('',#91,$,$);
#9=AXIS2_PLACEMENT_3D('',#92,$,$);
#11=AXIS2_PLACEMENT_3D('',#12,#13,#14);
#12=CARTESIAN_POINT('',({x},{y},0.));
#13=DIRECTION('',(0.,0.,1.));
#14=DIRECTION('',({cos},{sin},0.));
#15=PLANE('',#16);
#16=AXIS2_PLACEMENT_3D('',#17,$,$);
#17=CARTESIAN_POINT('',(0.,0.,-6.));
#18=DIRECTION('',(1.,0.,0.));
#20={operation}($,$,'O',5.,$,#30,#35,#36,0.5,#21,#22,#23,2.5,$,{allowance}{bottom});
#21={approach};
#22={retract};
#23={strategy};
#30=MILLING_CUTTING_TOOL('TOOL',#31,(),100.,$,$);
#31=TAPERED_ENDMILL(#32,4,{hand},.F.,$,$);
#32=MILLING_TOOL_DIMENSION({diameter},$,$,30.,0.,$,$);
#35=MILLING_TECHNOLOGY(0.01,.TCP.,$,-40.,$,.F.,.F.,.F.,$);
#36=MILLING_MACHINE_FUNCTIONS(.T.,$,$,.F.,$,(),.T.,$,$,());
#90=AXIS2_PLACEMENT_3D('',#93,$,$);
#91=CARTESIAN_POINT('',(-100.,-100.,-40.));
#92=CARTESIAN_POINT('',(0.,0.,40.));
#93=CARTESIAN_POINT('',(0.,0.,0.));
{feature}
ENDSEC;
END-ISO-10303-21;"""


@dataclass(frozen=True)
class Case:
    """A feature in its own coordinates."""

    text: str
    wanted: BaseGeometry
    """what is to be removed"""
    kept: BaseGeometry
    """material beside it that must stay"""
    is_face: bool = False


def length(number: int, value: float) -> str:
    return f"#{number}=TOLERANCED_LENGTH_MEASURE({value!r},$);"


@st.composite
def pockets(draw: st.DrawFn) -> Case:
    """Rectangle with rounded corners, perhaps a round island."""
    a, b = draw(st.floats(25.0, 70.0)), draw(st.floats(15.0, 60.0))
    radius = draw(st.sampled_from([0.0, 3.0, 7.0]))
    wanted: BaseGeometry = shapely.box(-a / 2, -b / 2, a / 2, b / 2)
    wanted = wanted.buffer(-radius).buffer(radius, quad_segs=256)
    kept = shapely.box(-90, -90, 90, 90) - wanted
    text = length(41, a) + length(42, b) + (length(43, radius) if radius else "")
    text += (
        "#40=RECTANGULAR_CLOSED_PROFILE($,#42,#41);#44=PLANAR_POCKET_BOTTOM_CONDITION();"
        f"#10=CLOSED_POCKET('F',$,(#20),#11,#15,({{}}),$,#44,$,{'#43' if radius else '$'},#40);"
    )
    size = draw(st.floats(2.0, 6.0))
    if draw(st.booleans()) and size + 1.0 < b / 2 - radius:
        text += "#50=BOSS('B',$,(),#11,#15,#51,$);#51=CIRCULAR_CLOSED_PROFILE($,#52);"
        text += length(52, 2.0 * size)
        island = shapely.Point(0, 0).buffer(size, quad_segs=256)
        return Case(text.format("#50"), wanted - island, kept.union(island))
    return Case(text.format(""), wanted, kept)


@st.composite
def open_pockets(draw: st.DrawFn) -> Case:
    """Rectangle, open to the front."""
    a, b = draw(st.floats(15.0, 60.0)), draw(st.floats(15.0, 60.0))
    wanted = shapely.box(0, 0, a, b)
    text = (
        f"#40=GENERAL_PROFILE($,#41);#41=POLYLINE('',(#42,#43,#44,#45));"
        f"#42=CARTESIAN_POINT('',(0.,0.,0.));#43=CARTESIAN_POINT('',(0.,{b!r},0.));"
        f"#44=CARTESIAN_POINT('',({a!r},{b!r},0.));#45=CARTESIAN_POINT('',({a!r},0.,0.));"
        "#46=PLANAR_POCKET_BOTTOM_CONDITION();"
        "#10=OPEN_POCKET('F',$,(#20),#11,#15,(),$,#46,$,$,#40,$);"
    )
    # The walls go on in front of the opening: the tool comes in between them.
    kept = shapely.box(-40, -60, a + 40, b + 40) - shapely.box(0, -60, a, b)
    return Case(text, wanted, kept)


@st.composite
def slots(draw: st.DrawFn) -> Case:
    """Straight slot along x, its ends drawn."""
    long, width = draw(st.floats(30.0, 80.0)), draw(st.floats(6.0, 30.0))
    half = 0.5 * width
    wanted: BaseGeometry = shapely.box(0, -half, long, half)
    free: BaseGeometry = wanted
    ends = [draw(st.sampled_from(["open", "round", "flat"])) for _ in range(2)]
    for end, x, beyond in zip(ends, (0.0, long), (-60.0, long + 60.0), strict=True):
        if end == "round":
            wanted = wanted.union(shapely.Point(x, 0).buffer(half, quad_segs=256))
        if end == "open":
            free = free.union(shapely.box(min(x, beyond), -half, max(x, beyond), half))
    kept = shapely.box(-60, -60, long + 60, 60) - free - wanted
    names = {"open": "OPEN_SLOT_END_TYPE()", "round": "RADIUSED_SLOT_END_TYPE()"}
    text = length(41, long) + length(42, width) + length(43, 0.0)
    text += f"#46={names.get(ends[0], 'FLAT_SLOT_END_TYPE(#43,#43)')};"
    text += f"#47={names.get(ends[1], 'FLAT_SLOT_END_TYPE(#43,#43)')};"
    text += (
        "#40=LINEAR_PATH($,#41,#18);#45=SQUARE_U_PROFILE($,#42,$,0.,$,0.);"
        "#10=SLOT('F',$,(#20),#11,#15,#40,#45,(#46,#47));"
    )
    return Case(text, wanted, kept)


@st.composite
def holes(draw: st.DrawFn) -> Case:
    """Round hole."""
    diameter = draw(st.floats(8.0, 60.0))
    wanted = shapely.Point(0, 0).buffer(0.5 * diameter, quad_segs=512)
    text = length(41, diameter) + "#42=THROUGH_BOTTOM_CONDITION();"
    text += "#10=ROUND_HOLE('F',$,(#20),#11,#15,#41,$,#42);"
    return Case(text, wanted, wanted.buffer(20.0) - wanted)


@st.composite
def faces(draw: st.DrawFn) -> Case:
    """Rectangle with nothing beside it."""
    a, b = draw(st.floats(20.0, 80.0)), draw(st.floats(20.0, 80.0))
    text = length(41, a) + f"#42=NUMERIC_PARAMETER('',{b!r},'mm');#19=DIRECTION('',(0.,1.,0.));"
    text += "#40=LINEAR_PATH($,#41,#19);#43=LINEAR_PROFILE($,#42);"
    text += "#10=PLANAR_FACE('F',$,(#20),#11,#15,#40,#43,$,());"
    return Case(text, shapely.box(0, 0, b, a), Polygon(), is_face=True)


@st.composite
def outsides(draw: st.DrawFn) -> Case:
    """Outside of a rectangle or of a circle."""
    a, b = draw(st.floats(40.0, 110.0)), draw(st.floats(40.0, 110.0))
    if draw(st.booleans()):
        kept: BaseGeometry = shapely.box(-a / 2, -b / 2, a / 2, b / 2)
        profile = "RECTANGULAR_CLOSED_PROFILE($,#42,#41)"
    else:
        kept = shapely.Point(0, 0).buffer(a / 2, quad_segs=512)
        profile = "CIRCULAR_CLOSED_PROFILE($,#41)"
    text = length(41, a) + length(42, b) + f"#40={profile};#43=LINEAR_PATH($,#41,#13);"
    text += "#10=GENERAL_OUTSIDE_PROFILE('F',$,(#20),#11,#15,#43,#40);"
    return Case(text, Polygon(), kept)


STRATEGIES = st.sampled_from([
    "UNIDIRECTIONAL_MILLING({o},.T.,#18,.CLIMB.)",
    "UNIDIRECTIONAL_MILLING({o},.T.,#18,.CONVENTIONAL.)",
    "BIDIRECTIONAL_MILLING({o},.T.,#18,.LEFT.,$)",
    "BIDIRECTIONAL_MILLING({o},.T.,#18,.RIGHT.,.LIFT_SHIFT_PLUNGE.)",
    "CONTOUR_PARALLEL({o},.T.,.CCW.,.CLIMB.)",
    "CONTOUR_PARALLEL({o},.T.,.CW.,.CLIMB.)",
    "CONTOUR_SPIRAL({o},.T.,.CCW.,.CONVENTIONAL.)",
    "CONTOUR_SPIRAL({o},.T.,.CCW.,.CLIMB.)",
    "BIDIRECTIONAL_CONTOUR({o},.T.,#18,.LEFT.,.CCW.,.CLIMB.)",
    "CONTOUR_BIDIRECTIONAL({o},.T.,#18,.LEFT.,.CCW.,.CLIMB.)",
    "CENTER_MILLING({o},.T.)",
])
WAYS = st.sampled_from([
    "PLUNGE_TOOLAXIS($)",
    "PLUNGE_RAMP($,5.)",
    "PLUNGE_HELIX($,3.,4.)",
    "PLUNGE_ZIGZAG($,6.,8.)",
    "AP_RETRACT_TANGENT($,3.)",
    "AP_RETRACT_ANGLE($,30.,4.)",
])


@dataclass(frozen=True)
class Workingstep:
    """A drawn workingstep, its geometry in the setup."""

    program: Program
    case: Case
    radius: float
    allowance: float


@st.composite
def workingsteps(draw: st.DrawFn) -> Workingstep:
    """Any feature, placed anywhere, with any tool and strategy."""
    case: Case = draw(
        st.one_of(pockets(), open_pockets(), slots(), holes(), faces(), outsides())
    )
    angle, x, y = draw(st.sampled_from([0.0, 17.0, 90.0])), draw(st.floats(-5, 5)), 3.0
    diameter = draw(st.floats(10.0 if case.wanted.is_empty else 4.0, 20.0))
    allowance = 0.0 if case.is_face else draw(st.sampled_from([0.0, 0.3]))
    operation = "PLANE_ROUGH_MILLING" if case.is_face else "BOTTOM_AND_SIDE_ROUGH_MILLING"
    text = PART.format(
        x=x,
        y=y,
        cos=repr(cos(radians(angle))),
        sin=repr(sin(radians(angle))),
        operation=operation,
        allowance="" if case.is_face else f"{allowance!r},",
        bottom="0.",
        approach=draw(WAYS),
        retract=draw(WAYS),
        strategy=draw(STRATEGIES).format(o=repr(draw(st.floats(0.05, 0.8)))),
        diameter=repr(diameter),
        hand=draw(st.sampled_from([".RIGHT.", ".LEFT."])),
        feature=case.text,
    )
    if case.is_face:
        text = text.replace("2.5,$,0.)", "2.5,0.)")
    program = Program(Part21File.from_bytes(text.encode(), name="drawn"))

    def placed(shape: BaseGeometry) -> BaseGeometry:
        turned = affinity.rotate(shape, angle, origin=(0, 0))
        return affinity.translate(turned, x, y)

    wanted, kept = placed(case.wanted), placed(case.kept)
    if case.wanted.is_empty:
        wanted = shapely.box(-SIDE, -SIDE, SIDE, SIDE) - kept
    found = Case(case.text, wanted, kept, case.is_face)
    return Workingstep(program, found, 0.5 * diameter, allowance)


def runs(path: ToolPath, *, below: float, step: float) -> Iterator[list[Point]]:
    """Feed moves as far as they go below a height; neighbours in one piece."""
    run: list[Point] = []
    for start, move in path.segments():
        points = [start, *points_along(start, move, step=step)]
        low = [point for point in points if point[2] < below]
        run = [*run, *low[len(run) > 0 :]]
        if move.feed is None or not low or low[-1] != points[-1]:
            if run:
                yield run if len(run) > 1 else run * 2
            run = []
    if run:
        yield run if len(run) > 1 else run * 2


def check_rapids(path: ToolPath) -> None:
    """Sideways above the stock, down to the retract plane, or up."""
    for start, move in path.segments():
        if move.feed is None:
            end = move.end
            is_sideways = dist(start[:2], end[:2]) > 1e-9
            assert not is_sideways or min(start[2], end[2]) >= TOP
            assert end[2] >= start[2] or end[2] >= RETRACT - 1e-9


@given(step=workingsteps())
@settings(max_examples=60, deadline=None)
def test_paths_reach_all_and_gouge_nothing(step: Workingstep) -> None:
    case, radius, allowance = step.case, step.radius, step.allowance
    near = case.kept.buffer(radius + allowance, quad_segs=128)
    centres = shapely.box(-200, -200, 200, 200) - near
    reached = centres.buffer(radius, quad_segs=128) & case.wanted
    if reached.buffer(-0.01).area < 1.0:
        # No room for the tool, or so little that a pass along the middle may be made.
        with suppress(PathError):
            workingstep_path(step.program, step.program.workingsteps[0])
        return
    path = workingstep_path(step.program, step.program.workingsteps[0])
    check_rapids(path)
    shapely.prepare(case.kept)
    low = MultiLineString(list(runs(path, below=-1e-6, step=FINE)))
    assert not shapely.dwithin(case.kept, low, radius + allowance - CLOSE)
    contact = [move for move in path.moves if move.type is MoveType.CONTACT]
    assert contact
    heights = {round(move.end[2], 6) for move in contact}
    assert heights == {-2.0, -4.0, -6.0}
    floor = MultiLineString(list(runs(path, below=-DEPTH + 1e-6, step=COARSE)))
    swept = floor.buffer(radius, quad_segs=32)
    left = (reached - swept).area
    assert left <= 0.005 * reached.area + 0.05
