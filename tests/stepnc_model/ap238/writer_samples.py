"""Ten AP238 programs of tool paths alone, in the manner of four kinds of writers.

An editor of AP238 programs (features without depth, tools as dimensions), a post-processor of a
CAM system (tools by number, vendor's properties), a converter of APT (setups, cutter contact)
and a turning system. Sizes are in the unit of each program.
"""

from collections.abc import Callable, Iterator
from math import sin
from pathlib import Path

from tests.stepnc_model.ap238.aim_text import AimText, Manner, Point

EDITOR = Manner(writer="editor", about="ARM_SCHEMA: ap238_arm_schema", describes=True, first=10)
EDITOR_INCH = Manner(writer="editor", describes=True, first=10, length="inch")
POST = Manner(writer="post", about="Experimental AP238 toolpath")
POST_INCH = Manner(writer="post", length="inch", step=5, ending="\r\n")
APT = Manner(
    writer="apt",
    schema="MODEL_BASED_INTEGRATED_MANUFACTURING_SCHEMA",
    describes=True,
    first=100,
    step=10,
)
LATHE = Manner(writer="turning")
LATHE_INCH = Manner(writer="turning", length="inch", ending="\r\n")

END_MILL = {
    "effective cutting diameter": 16.0,
    "maximum depth of cut": 30.0,
    "overall assembly length": 60.0,
}


def editor_face_inch() -> str:
    """Facing in inches: rapids as speed profile with a technology of feed 0, shared ones."""
    t = AimText(EDITOR_INCH)
    plan, group = t.plan("Main Workplan"), t.plan("Group-1")
    piece = t.workpiece(t.project(plan))
    t.block(piece, (-2, -1.5, -1), (4, 3, 1.05))
    t.next(plan, group)
    none, cutting = t.technology(spindle=800, feed=0), t.technology(spindle=800, feed=12)
    cuts = []
    for level, z in enumerate((0.03, 0.0)):
        feature = t.feature(at=t.place())
        cut = t.step(group, f"WS {level}", "FREEFORM_MILLING_OPERATION", feature=feature)
        t.uses(cut, none)
        t.functions(cut, coolant="coolant off", chip_removal="chip removal off")
        t.path(cut, t.polyline([(-3, -1, 2), (-3, -1, 0.2)]), technology=none, is_rapid=True)
        t.path(cut, t.polyline([(-3, -1, 0.2), (-3, -1, z)]), technology=cutting)
        rows = [(-3, -1, z), (3, -1, z), (3, 0, z), (-3, 0, z), (-3, 1, z), (3, 1, z)]
        t.path(cut, t.polyline(rows), technology=cutting)
        t.path(cut, t.polyline([(3, 1, z), (3, 1, 2)]), technology=none, is_rapid=True)
        cuts.append(cut)
    sizes = {
        "effective cutting diameter": 1.5,
        "corner radius": 0.03,
        "maximum depth of cut": 0.5,
        "overall assembly length": 3.0,
    }
    t.tool("3", "user defined milling tool", cuts, sizes)
    return t.text()


def editor_pocket_nested() -> str:
    """A pocket in nested workplans: each path has a technology, some have no length."""
    t = AimText(EDITOR)
    plan, outer, inner = t.plan("Main Workplan"), t.plan("Job"), t.plan("Pocket")
    piece = t.workpiece(t.project(plan))
    t.block(piece, (0, 0, -30), (120, 90, 30))
    t.next(plan, outer)
    t.next(outer, inner)
    cuts = []
    for name, z, step in (("rough", -4.0, 0.0), ("finish", -4.2, 0.2)):
        cut = t.step(inner, name, "FREEFORM_MILLING_OPERATION", feature=t.feature())
        t.uses(cut, t.technology(spindle=-2400))
        a, b, c, d = 20 - step, 100 + step, 20 - step, 70 + step
        start: Point = (a, c, 10)
        t.path(cut, t.polyline([start, start]), is_rapid=True)
        t.path(
            cut,
            t.polyline([start, (a, c, 1), (a, c, 1)]),
            technology=t.technology(spindle=-2400, feed=3000),
        )
        t.path(
            cut,
            t.polyline([(a, c, 1), (b, c, z), (b, c, z)]),
            technology=t.technology(spindle=-2400, feed=200),
        )
        ring = [(b, c, z), (b, d, z), (a, d, z), (a, c, z), (b, c, z)]
        rows = [(b, c + 12, z), (a + 12, c + 12, z), (a + 12, c + 24, z), (b, c + 24, z)]
        t.path(
            cut, t.polyline([*ring, *rows]), technology=t.technology(spindle=-2400, feed=600)
        )
        t.path(cut, t.polyline([rows[-1], (b, c + 24, 10)]), is_rapid=True)
        cuts.append(cut)
    t.tool("5", "endmill", cuts, END_MILL, teeth=3)
    return t.text()


def editor_drilling() -> str:
    """Four holes by paths of a drill, one path each, with one technology for all."""
    t = AimText(EDITOR)
    plan = t.plan("Main Workplan")
    piece = t.workpiece(t.project(plan))
    t.block(piece, (0, 0, -20), (80, 60, 20))
    cut = t.step(plan, "drill", "FREEFORM_MILLING_OPERATION", feature=t.feature(at=t.place()))
    drilling = t.technology(spindle=-1500, feed=180)
    t.uses(cut, drilling)
    at: Point = (10, 10, 20)
    for x, y in ((10, 10), (70, 10), (70, 50), (10, 50)):
        t.path(cut, t.polyline([at, (x, y, 20), (x, y, 2)]), is_rapid=True)
        t.path(cut, t.polyline([(x, y, 2), (x, y, -15)]), technology=drilling)
        t.path(cut, t.polyline([(x, y, -15), (x, y, 20)]), is_rapid=True)
        at = (x, y, 20)
    sizes = {"effective cutting diameter": 8.0, "maximum depth of cut": 60.0}
    t.tool("8", "twist drill", [cut], sizes, teeth=2)
    return t.text()


def editor_ball_splines() -> str:
    """Finishing of a waved face with a ball end mill along B-splines, with tool axes."""
    t = AimText(EDITOR)
    plan = t.plan("Main Workplan")
    piece = t.workpiece(t.project(plan))
    t.block(piece, (0, 0, -20), (80, 12, 18.5))
    cut = t.step(plan, "finish", "FREEFORM_MILLING_OPERATION", feature=t.feature(of="$"))
    t.uses(cut, t.technology(spindle=-6800, feed=900))
    t.path(cut, t.polyline([(0, 2, 20), (0, 2, 0)]), is_rapid=True)
    t.path(cut, t.polyline([(0, 2, 0), (0, 2, -2)]))
    for row in range(5):
        y = 2.0 + 2.0 * row
        xs = [8.0 * step for step in range(11)]
        poles = [(x, y, -2.0 + sin(x / 8.0)) for x in (xs if row % 2 == 0 else xs[::-1])]
        way = t.path(cut, t.spline(poles))
        axis = t.polyline([(0, 0, 1), (0, 0, 1)])
        shown = t.add(f"REPRESENTATION('',({axis}),{t.context})")
        t.prop(way, "tool axis", shown, kind="cutter location trajectory")
    t.path(cut, t.polyline([(80, 10, -2), (80, 10, 20)]), is_rapid=True)
    sizes = {"effective cutting diameter": 10.0, "maximum depth of cut": 20.0}
    t.tool("B10", "ballnose endmill", [cut], sizes, teeth=2)
    return t.text()


def post_contour_arcs() -> str:
    """Contour with arcs as trimmed circles and as a vendor's property; no feature at all."""
    t = AimText(POST)
    plan = t.plan("UNNAMED")
    t.word(plan, "vendor profile", "milling-toolpath/0.2")
    t.workpiece(t.project(plan))
    cuts = []
    for number, z in enumerate((-3.0, -6.0), 1):
        cut = t.step(plan, f"2D-Contour{number}", "MILLING_TYPE_OPERATION")
        t.word(cut, "vendor tool offset", "2")
        own = t.technology(spindle=-4500)
        t.word(own, "feedrate reference", "tool center point")
        t.uses(cut, own)
        t.functions(cut, coolant="coolant on", coolant_type="flood")
        enter, mill = (t.technology(spindle=-4500, feed=feed) for feed in (400, 1200))
        t.path(cut, t.polyline([(-30, -48, 15), (-30, -48, 5)]), technology=own, is_rapid=True)
        t.path(cut, t.polyline([(-30, -48, 5), (-30, -48, z)]), technology=enter)
        side = t.polyline([(-30, -48, z), (-30, -38, z), (30, -38, z)])
        bend = t.arc((30, -28, z), (30, -38, z), (40, -28, z))
        t.path(cut, t.chain([side, bend]), technology=mill)
        t.path(cut, t.polyline([(40, -28, z), (40, 28, z)]), technology=mill)
        corner = t.path(cut, technology=mill)
        t.word(
            corner,
            "next-nc circular motion",
            f'{{"start":[40,28,{z}],"end":[30,38,{z}],"center":[30,28,{z}],"plane":"XY",'
            '"clockwise":false,"sweepRadians":1.5707963267948966,"axialRise":0}',
        )
        t.path(cut, t.polyline([(30, 38, z), (-40, 38, z), (-40, -38, z)]), technology=mill)
        t.path(cut, t.polyline([(-40, -38, z), (-40, -38, 15)]), technology=own, is_rapid=True)
        cuts.append(cut)
    t.tool("2", "flat 12 mm", cuts, kind="cutting tool")
    return t.text()


def post_two_tools_inch() -> str:
    """Facing and drilling in inches without stock: two tools by number, feeds that lack."""
    t = AimText(POST_INCH)
    plan = t.plan("JOB")
    t.project(plan)
    face = t.step(plan, "FACE", "MILLING_TYPE_OPERATION", feature=t.feature())
    fast = t.technology(spindle=-3000, feed=400)
    still = t.technology(spindle=-3000, feed=0)
    t.uses(face, still)
    t.path(face, t.polyline([(-1.5, 0, 1), (-1.5, 0, 0.1)]), technology=fast)
    t.path(face, t.polyline([(-1.5, 0, 0.1), (-1.5, 0, -0.02)]), technology=still)
    t.path(face, t.polyline([(-1.5, 0, -0.02), (3.5, 0, -0.02)]), technology=still)
    t.path(face, t.polyline([(3.5, 0, -0.02), (3.5, 0, 1)]), technology=fast)
    hole = t.step(plan, "HOLES", "DRILLING_OPERATION")
    drilling = t.technology(spindle=-2000, feed=5)
    t.uses(hole, drilling)
    for x in (0.5, 1.5):
        t.path(hole, t.polyline([(x, 0, 1), (x, 0, 0.1)]), is_rapid=True)
        t.path(hole, t.polyline([(x, 0, 0.1), (x, 0, -0.6)]))
        t.path(hole, t.polyline([(x, 0, -0.6), (x, 0, 1)]), is_rapid=True)
    t.tool("1", "", [face], kind="cutting tool")
    t.tool("4", "", [hole], kind="cutting tool")
    return t.text()


def apt_two_setups() -> str:
    """Two setups of one block, the second turned over about x; one tool for both."""
    t = AimText(APT)
    plan = t.plan("main workplan")
    piece = t.workpiece(t.project(plan))
    t.block(piece, (0, 0, 0), (100, 60, 40))
    cuts = []
    # Paths are in coordinates of the workpiece: the second face is its underside.
    for number, (place, top, up) in enumerate(
        (
            (t.place(at=(0, 0, -40)), 40.0, 1.0),
            (t.place(at=(0, 60, 0), axis=(0, 0, -1)), 0.0, -1.0),
        ),
        1,
    ):
        group = t.plan(f"setup {number}")
        t.next(plan, group)
        t.setup(group, t.place(at=(150, 90, 60)), piece, place)
        cut = t.step(group, f"face {number}", "FREEFORM_MILLING_OPERATION")
        t.uses(cut, t.technology(spindle=-2000, feed=500))
        z = top - up
        above = top + 30.0 * up
        t.path(cut, t.polyline([(-20, 8, above), (-20, 8, z)]), is_rapid=True)
        rows: list[Point] = []
        for row in range(4):
            ends = [(-20.0, 8.0 + 14 * row, z), (120.0, 8.0 + 14 * row, z)]
            rows += ends if row % 2 == 0 else ends[::-1]
        t.path(cut, t.polyline(rows))
        t.path(cut, t.polyline([rows[-1], (-20, 50, above)]), is_rapid=True)
        cuts.append(cut)
    t.tool("T1", "endmill", cuts, END_MILL, teeth=4)
    return t.text()


def apt_cutter_contact() -> str:
    """A side milled by the points where the cutter touches it, with surface normals."""
    t = AimText(APT)
    plan = t.plan("main workplan")
    piece = t.workpiece(t.project(plan))
    t.block(piece, (0, 0, -20), (100, 50, 20))
    at = t.place()
    cut = t.step(plan, "side", "SIDE_MILLING_OPERATION", feature=t.feature(at=at))
    t.uses(cut, t.technology(spindle=-2000, feed=400))
    t.path(cut, t.polyline([(-20, -20, 30), (-20, -7, 2)]), is_rapid=True)
    t.path(cut, t.polyline([(-20, -7, 2), (-20, -7, -10)]))
    way = t.path(cut, kind="cutter contact trajectory")
    for name, points in (
        ("basic curve", [(-20, 1, -10), (50, 1, -10), (120, 1, -10)]),
        ("surface normal", [(0, -1, 0), (0, -1, 0), (0, -1, 0)]),
    ):
        shown = t.add(f"REPRESENTATION('',({t.polyline(points)}),{t.context})")
        t.prop(way, name, shown, kind="cutter contact trajectory")
    t.word(way, "contact type", "side", kind="cutter contact trajectory")
    t.path(cut, t.polyline([(120, -7, -10), (120, -7, 30)]), is_rapid=True)
    t.tool("T2", "endmill", [cut], END_MILL, teeth=4)
    return t.text()


def lathe_constant_surface_speed() -> str:
    """Rough turning in two cuts and finishing with constant surface speed."""
    t = AimText(LATHE)
    plan = t.plan("TURN")
    piece = t.workpiece(t.project(plan))
    t.bar(piece, 60, -120, 121)
    cuts = []
    for name, radii, feed in (("ROUGH", (28.0, 26.0), 0.25), ("FINISH", (25.5,), 0.1)):
        cut = t.step(plan, name, "TURNING_TYPE_OPERATION", kind="turning")
        own = t.technology(surface=(180, 2500), per_turn=feed, kind="turning")
        t.uses(cut, own)
        for radius in radii:
            t.path(cut, t.polyline([(40, 0, 5), (radius, 0, 3)]), is_rapid=True)
            t.path(
                cut,
                t.polyline([(radius, 0, 3), (radius, 0, -60), (32, 0, -60)]),
                technology=own,
            )
            t.path(cut, t.polyline([(32, 0, -60), (40, 0, 5)]), is_rapid=True)
        cuts.append(cut)
    kind = "turning cutting tool"
    tool = t.tool("T0101", "general turning tool", cuts, kind=kind)
    t.insert(tool, corner=0.8, depth=6.0)
    return t.text()


def lathe_face_groove_inch() -> str:
    """Facing with a constant spindle speed and a groove with an insert, in inches."""
    t = AimText(LATHE_INCH)
    plan = t.plan("TURN")
    piece = t.workpiece(t.project(plan))
    t.bar(piece, 2, -4, 4.05)
    face = t.step(plan, "FACE", "TURNING_TYPE_OPERATION", kind="turning")
    t.uses(face, t.technology(spindle=1200, per_turn=0.006, kind="turning"))
    t.path(face, t.polyline([(1.5, 0, 0.5), (1.15, 0, 0)]), is_rapid=True)
    t.path(face, t.polyline([(1.15, 0, 0), (0, 0, 0)]))
    t.path(face, t.polyline([(0, 0, 0), (0, 0, 0.2), (1.5, 0, 0.5)]), is_rapid=True)
    groove = t.step(plan, "GROOVE", "GROOVING_TURNING_OPERATION", kind="turning")
    t.uses(groove, t.technology(spindle=900, per_turn=0.003, kind="turning"))
    t.path(groove, t.polyline([(1.5, 0, 0.5), (1.5, 0, -1), (1.15, 0, -1)]), is_rapid=True)
    t.path(groove, t.polyline([(1.15, 0, -1), (0.8, 0, -1)]))
    t.path(groove, t.polyline([(0.8, 0, -1), (1.5, 0, -1)]), is_rapid=True)
    kind = "turning cutting tool"
    turning = t.tool("T0101", "general turning tool", [face], kind=kind)
    t.insert(turning, corner=0.03, depth=0.2)
    sizes = {"cutting width": 0.125, "corner radius": 0.008}
    tool = t.tool("T0303", "grooving tool", [groove], sizes, kind=kind)
    t.insert(tool, corner=0.008, depth=0.5)
    return t.text()


SAMPLES: tuple[Callable[[], str], ...] = (
    editor_face_inch,
    editor_pocket_nested,
    editor_drilling,
    editor_ball_splines,
    post_contour_arcs,
    post_two_tools_inch,
    apt_two_setups,
    apt_cutter_contact,
    lathe_constant_surface_speed,
    lathe_face_groove_inch,
)

TOOLS = (
    "number,kind,diameter_mm,teeth,edge_length_mm,cutting_material\n"
    "1,facemill,50,5,8,carbide\n"
    "2,endmill,12,3,25,carbide\n"
    "4,drill,6,2,40,carbide\n"
)
"""Table of the tools that programs only name."""


def write_samples(folder: Path) -> None:
    """Write the ten programs and the table of their tools into a folder."""
    for name, text in samples():
        (folder / name).write_bytes(text.encode())
    (folder / "tools.csv").write_text(TOOLS, encoding="utf-8")


def samples() -> Iterator[tuple[str, str]]:
    """Names of the ten programs, and their texts."""
    for make in SAMPLES:
        yield f"{make.__name__}.stpnc", make()
