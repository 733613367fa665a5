"""The project's own sample parts: faultless programs, and sensible ones."""

from collections import Counter
from itertools import pairwise
from math import pi
from pathlib import Path
from typing import TypeVar

import pytest

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.features import ClosedPocket, MachiningFeature, OpenPocket
from stepnc_model.entities.geometry import Axis2Placement3d, Block, CartesianPoint
from stepnc_model.entities.milling import MillingMachiningOperation
from stepnc_model.entities.profiles import SurfaceTextureParameter
from stepnc_model.entities.technology import MillingTechnology
from stepnc_model.entities.turning import ThreadStrategy, UnidirectionalTurning
from stepnc_model.entities.turning_tools import TurningThreadingTool
from stepnc_model.part21.values import Ref, Value
from stepnc_model.programs.program import Program
from stepnc_model.programs.technology import ProgrammedQuantity, programmed
from stepnc_model.programs.tool import tool_of

PARTS = Path(__file__).parents[2] / "examples" / "parts"
PAPER003 = ["paper003_case1", "paper003_case2", "paper003_pocket"]
NAMES = ["bracket", "paper000", "paper002", *PAPER003, "shaft"]
ROOTS = {"PROJECT", "SURFACE_TEXTURE_PARAMETER"}

E = TypeVar("E", bound=Entity)


def load(name: str) -> Program:
    return Program.load(PARTS / f"{name}.stpnc")


@pytest.fixture(scope="module")
def bracket() -> Program:
    return load("bracket")


@pytest.fixture(scope="module")
def shaft() -> Program:
    return load("shaft")


def all_of(program: Program, cls: type[E]) -> list[E]:
    return [entity for _, entity in program.model.of_type(cls)]


def location(program: Program, placement: Ref[Axis2Placement3d]) -> tuple[float, ...]:
    return program.get(program.get(placement).location).coordinates


def references(value: Value) -> set[int]:
    if isinstance(value, Ref):
        return {int(value)}
    inner = value if isinstance(value, tuple) else ()
    return set().union(*(references(each) for each in inner))


@pytest.mark.parametrize("name", NAMES)
def test_part_has_no_findings(name: str) -> None:
    assert [str(finding) for finding in load(name).findings()] == []


@pytest.mark.parametrize("name", NAMES)
def test_every_instance_is_of_use(name: str) -> None:
    file = load(name).file
    used = set().union(*(references(file.parameters(number)) for number in file.ids()))
    assert {file.keyword(number) for number in file.ids() if number not in used} <= ROOTS


@pytest.mark.parametrize("name", NAMES)
def test_feature_and_operation_know_each_other(name: str) -> None:
    program = load(name)
    for step in program.workingsteps:
        for ref in step.features:
            position = program.model.position(ref, "its_operations")
            operations = program.file.parameters(int(ref))[position]
            assert step.operation_ref in references(operations)


@pytest.mark.parametrize("name", NAMES)
def test_every_workingstep_has_tool_feed_and_speed(name: str) -> None:
    program = load(name)
    for step in program.workingsteps:
        assert tool_of(program, step.tool_ref).teeth >= 1
        assert programmed(program, step.technology_ref).feed is not None


def test_paper002_has_the_numbers_of_table_2() -> None:
    program = load("paper002")
    (step,) = program.workingsteps
    tool = tool_of(program, step.tool_ref)
    (block,) = all_of(program, Block)
    technology = programmed(program, step.technology_ref)
    assert technology.speed.quantity is ProgrammedQuantity.CUTTING_SPEED
    assert technology.speed.value * 60.0 / 1000.0 == pytest.approx(35.0)
    assert technology.spindle_speed(tool.diameter) * 60.0 == pytest.approx(618.9, abs=0.05)
    assert getattr(step.operation, "axial_cutting_depth", None) == 3.0
    assert (tool.diameter, tool.teeth, block.x, block.y) == (18.0, 4, 18.0, 300.0)


def test_paper000_has_the_numbers_of_section_4_1() -> None:
    program = load("paper000")
    (step,) = program.workingsteps
    (strategy,) = all_of(program, UnidirectionalTurning)
    technology = programmed(program, step.technology_ref)
    assert technology.feed.quantity is ProgrammedQuantity.FEED_PER_REVOLUTION
    assert technology.feed.value == 0.25
    assert 2.0 * pi * technology.spindle_speed(50.0) == pytest.approx(166.5)
    assert (strategy.cutting_depth, strategy.overcut_length) == ((2.5,), 2.0)


@pytest.mark.parametrize(("case", "feed", "depth"), [(1, 124.46, 1.5), (2, 88.9, 2.0)])
def test_paper003_has_the_numbers_of_section_4_3(case: int, feed: float, depth: float) -> None:
    program = load(f"paper003_case{case}")
    (step,) = program.workingsteps
    (block,) = all_of(program, Block)
    tool = tool_of(program, step.tool_ref)
    technology = programmed(program, step.technology_ref)
    assert technology.feed.quantity is ProgrammedQuantity.FEED
    assert technology.feed.value * 60.0 == pytest.approx(feed)
    assert technology.spindle_speed(tool.diameter) * 60.0 == pytest.approx(1750.0)
    assert getattr(step.operation, "axial_cutting_depth", None) == depth
    assert (tool.diameter, tool.teeth) == (8.0, 4)
    assert (block.x, block.y, block.z) == (101.6, 101.6, 12.7)


def test_the_pocket_of_paper003_has_the_middles_of_section_4_2() -> None:
    program = load("paper003_pocket")
    (step,) = program.workingsteps
    tool = tool_of(program, step.tool_ref)
    technology = programmed(program, step.technology_ref)
    assert technology.feed.value == pytest.approx(0.5 * (30.0 + 90.0))
    speed = technology.spindle_speed(tool.diameter)
    assert 2.0 * pi * speed == pytest.approx(0.5 * (75.4 + 226.2))
    assert getattr(step.operation, "axial_cutting_depth", None) == 0.5 * (2.5 + 3.5)
    assert (tool.diameter, tool.teeth) == (8.0, 4)


@pytest.mark.parametrize("name", ["bracket", "paper002", *PAPER003])
def test_milling_programs_one_feed_and_one_speed(name: str) -> None:
    """ISO 14649-11, rules WR1 and WR2."""
    for technology in all_of(load(name), MillingTechnology):
        assert (technology.cutspeed is None) != (technology.spindle is None)
        assert (technology.feedrate is None) != (technology.feedrate_per_tooth is None)


def test_right_hand_tools_turn_clockwise(bracket: Program) -> None:
    spindles = [each.spindle for each in all_of(bracket, MillingTechnology) if each.spindle]
    assert spindles
    assert max(spindles) < 0.0


def test_features_lie_within_the_stock(bracket: Program) -> None:
    (block,) = all_of(bracket, Block)
    corner = location(bracket, block.position)
    size = (block.x, block.y, block.z)
    for feature in all_of(bracket, MachiningFeature):
        top = location(bracket, feature.feature_placement)
        depth = location(bracket, bracket.get(feature.depth).position)
        bottom = (top[0], top[1], top[2] + depth[2])
        for point in (top, bottom):
            for axis in range(3):
                assert corner[axis] <= point[axis] <= corner[axis] + size[axis]
        assert depth[2] < 0.0


def test_end_mills_fit_the_corners_of_the_pockets(bracket: Program) -> None:
    pockets = 0
    for step in bracket.workingsteps:
        feature = bracket.get(step.features[0])
        if isinstance(feature, (ClosedPocket, OpenPocket)):
            pockets += 1
            assert feature.orthogonal_radius is not None
            corner = bracket.get(feature.orthogonal_radius).theoretical_size
            assert tool_of(bracket, step.tool_ref).diameter / 2.0 < corner
    assert pockets == 4


def test_cutting_edges_are_longer_than_the_cuts(bracket: Program) -> None:
    for step in bracket.workingsteps:
        depth = getattr(step.operation, "axial_cutting_depth", None)
        length = tool_of(bracket, step.tool_ref).cutting_edge_length
        assert depth is None or (length is not None and depth < length)


def test_finishing_leaves_nothing_and_roughing_does(bracket: Program) -> None:
    for step in bracket.workingsteps:
        if not isinstance(step.operation, MillingMachiningOperation):
            continue
        left = [
            getattr(step.operation, name, None)
            for name in ("allowance_side", "allowance_bottom")
        ]
        if "finish" in step.operation_type:
            assert not any(left)
        if step.id.startswith("ROUGH"):
            assert any(left)


def test_some_operations_share_their_technology(bracket: Program) -> None:
    steps = {step.operation_ref: step.technology_ref for step in bracket.workingsteps}
    assert max(Counter(steps.values()).values()) >= 2


def test_the_reamers_feed_is_nobodys_to_touch(bracket: Program) -> None:
    inhibited = {
        step.operation_type
        for step in bracket.workingsteps
        if programmed(bracket, step.technology_ref).inhibition
    }
    assert inhibited == {"reaming"}


def test_finished_face_and_holes_have_a_roughness(bracket: Program) -> None:
    required = {
        bracket.get(bracket.get(surface).its_machining_feature).its_id: texture.its_value
        for texture in all_of(bracket, SurfaceTextureParameter)
        for surface in texture.applied_surfaces
    }
    assert required["TOP"] == 1.6
    assert required["HOLE 1"] == required["HOLE 2"] == 0.8


def test_workplans_are_nested(bracket: Program) -> None:
    assert max(executable.level for executable in bracket.executables) == 2


def test_contour_closes(bracket: Program) -> None:
    file = bracket.file
    ends: list[tuple[Value, Value]] = []
    (contour,) = file.ids_of("COMPOSITE_CURVE")
    for segment in sorted(references(file.parameters(contour))):
        (curve,) = references(file.parameters(segment))
        values = file.parameters(curve)
        if file.keyword(curve) == "POLYLINE":
            points = values[1]
            assert isinstance(points, tuple)
            ends.append((points[0], points[-1]))
        else:
            assert isinstance(values[2], tuple)
            assert isinstance(values[3], tuple)
            ends.append((values[2][0], values[3][0]))
    assert all(before[1] == after[0] for before, after in pairwise([*ends, ends[0]]))


def test_thread_is_cut_to_its_depth(shaft: Program) -> None:
    """0.6134 times the pitch, ISO 68-1: 17/24 of H less the rounded root."""
    (tool,) = all_of(shaft, TurningThreadingTool)
    (strategy,) = all_of(shaft, ThreadStrategy)
    assert sum(strategy.cutting_depth) == pytest.approx(0.6134 * tool.threading_pitch, abs=1e-3)


def test_thread_feeds_one_pitch_a_revolution(shaft: Program) -> None:
    (tool,) = all_of(shaft, TurningThreadingTool)
    technology = programmed(shaft, shaft.workingsteps[-1].technology_ref)
    assert technology.feed.quantity is ProgrammedQuantity.FEED_PER_REVOLUTION
    assert technology.feed.value == tool.threading_pitch
    assert technology.is_synchronised
    assert technology.inhibition


def test_lathe_stays_below_its_greatest_speed(shaft: Program) -> None:
    speeds = [
        programmed(shaft, step.technology_ref).spindle_speed(1.0) for step in shaft.workingsteps
    ]
    assert max(speeds) <= 50.0


def test_contour_of_the_shaft_lies_within_the_bar(shaft: Program) -> None:
    for point in all_of(shaft, CartesianPoint):
        x, y, z = point.coordinates
        assert y == 0.0
        assert 0.0 <= x <= 30.0
        assert -150.0 <= z <= 10.0


def test_roughing_speed_suits_carbide_in_c45(bracket: Program) -> None:
    """60 to 200 m/min: a careful part, with room above it."""
    for step in bracket.workingsteps[:10]:
        tool = tool_of(bracket, step.tool_ref)
        speed = programmed(bracket, step.technology_ref).spindle_speed(tool.diameter)
        assert 60.0 <= pi * tool.diameter * speed * 60.0 / 1000.0 <= 200.0
