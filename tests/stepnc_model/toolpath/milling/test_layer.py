"""One level of an area: where its passes lie, and how they run."""

from dataclasses import replace
from math import pi
from pathlib import Path

import pytest
import shapely
from shapely.geometry.base import BaseGeometry

from stepnc_model.entities.entity import Entity
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.milling.contour import area, chain_length, circle, clockwise, polygon
from stepnc_model.toolpath.milling.cover import Area, Wall, swept, upright
from stepnc_model.toolpath.milling.layer import CutLevel, Layer, clear, wall_passes
from stepnc_model.toolpath.milling.strategy import Covering, EndMillShape, ResolvedStrategy
from stepnc_model.toolpath.task import ToolPathTask, job_of

PARTS = Path(__file__).parents[4] / "examples" / "parts"
END = "ENDSEC;\nEND-ISO-10303-21;"


def edited(*changes: tuple[str, str], more: str = "") -> Program:
    """The bracket with some texts replaced and instances added."""
    text = (PARTS / "bracket.stpnc").read_text(encoding="utf-8")
    for before, after in (*changes, (END, f"{more}\n{END}")):
        assert before in text, before
        text = text.replace(before, after)
    return Program(Part21File.from_bytes(text.encode(), name="bracket"))


def job_at(id: str, *changes: tuple[str, str], more: str = "") -> ToolPathTask:
    """Job of the workingstep with a name."""
    program = edited(*changes, more=more)
    step = next(step for step in program.workingsteps if step.id == id)
    return job_of(program, step)


SQUARE = polygon([0j, 40 + 0j, 40 + 40j, 40j])
POCKET = Area(
    ref=Ref[Entity](140), walls=(Wall(loop=SQUARE, inset=upright),), top=0.0, bottom=-10.0
)
FACE = Area(ref=Ref[Entity](100), walls=(), top=0.0, bottom=-2.0, face=SQUARE, solid=SQUARE)
LEVEL = CutLevel(z=-2.0, above=0.0, cutter=EndMillShape(radius=5.0), allowance=0.0)
WAY = ResolvedStrategy(
    covering=Covering.RINGS,
    step=5.0,
    along=1 + 0j,
    steps_left=True,
    is_lifted=False,
    is_counter_clockwise=True,
    is_inside_out=True,
    has_wall_on_right=True,
)
REACHED = 1600.0 - (4.0 - pi) * 25.0
"""mm² of a square of 40 mm that a tool of 10 mm gets at"""


@pytest.fixture(scope="module")
def job() -> ToolPathTask:
    return job_at("ROUGH POCKET")


def cleared(job: ToolPathTask, found: Area, way: ResolvedStrategy) -> Layer:
    layer = clear(job, found, LEVEL, way)
    assert layer is not None
    return layer


def test_rings_run_inside_out_or_outside_in_and_in_their_sense(job: ToolPathTask) -> None:
    sizes = [area(cut.chain) for cut in cleared(job, POCKET, WAY).passes]
    assert sizes == pytest.approx([100.0, 400.0, 900.0])
    turned = replace(WAY, is_inside_out=False, is_counter_clockwise=False)
    sizes = [area(cut.chain) for cut in cleared(job, POCKET, turned).passes]
    assert sizes == pytest.approx([-900.0, -400.0, -100.0])


@pytest.mark.parametrize("covering", list(Covering))
@pytest.mark.parametrize("step", [3.0, 8.0])
def test_every_strategy_clears_all_that_the_tool_gets_at(
    job: ToolPathTask, covering: Covering, step: float
) -> None:
    way = replace(WAY, covering=covering, step=step, is_lifted=covering is Covering.ONE_WAY)
    layer = cleared(job, POCKET, way)
    assert swept(layer.passes, 5.0).area == pytest.approx(REACHED, abs=1.5)


@pytest.mark.parametrize("covering", list(Covering))
def test_every_strategy_sweeps_a_face_and_runs_over_its_edge(
    job: ToolPathTask, covering: Covering
) -> None:
    layer = cleared(job, FACE, replace(WAY, covering=covering))
    from_shapely = swept(layer.passes, 5.0)
    left = 1600.0 - from_shapely.intersection(swept_square()).area
    # Rings along the edge itself keep the tool's middle on it.
    assert left == pytest.approx(0.0, abs=0.01)


def swept_square() -> BaseGeometry:
    return shapely.box(0, 0, 40, 40)


def test_free_side_is_inside_the_rings(job: ToolPathTask) -> None:
    assert cleared(job, POCKET, WAY).room.side == 1j
    assert cleared(job, POCKET, replace(WAY, is_counter_clockwise=False)).room.side == -1j


def test_pocket_as_wide_as_the_tool_leaves_no_room_beside_the_pass(job: ToolPathTask) -> None:
    hole = replace(POCKET, walls=(Wall(loop=circle(0j, 5.0), inset=upright),))
    layer = cleared(job, hole, WAY)
    assert layer.room.clearance(0j) < 0.0
    assert not layer.room.holds(layer.passes[0].chain)


def test_tool_that_is_too_wide_makes_no_layer(job: ToolPathTask) -> None:
    hole = replace(POCKET, walls=(Wall(loop=circle(0j, 4.9), inset=upright),))
    assert clear(job, hole, LEVEL, WAY) is None
    assert wall_passes(hole, LEVEL, WAY) is None


def test_wall_passes_follow_wall_and_island_with_the_wall_on_the_side_asked_for() -> None:
    island = Wall(loop=clockwise(circle(20 + 20j, 2.0)), inset=upright)
    found = replace(POCKET, walls=(*POCKET.walls, island))
    layer = wall_passes(found, LEVEL, WAY)
    assert layer is not None
    assert sorted(area(cut.chain) for cut in layer.passes) == pytest.approx([-49.0 * pi, 900.0])
    other = wall_passes(found, LEVEL, replace(WAY, has_wall_on_right=False))
    assert other is not None
    assert sorted(area(cut.chain) for cut in other.passes) == pytest.approx([-900.0, 49.0 * pi])


def test_wall_passes_leave_out_the_open_side() -> None:
    open_side = (SQUARE[0],)
    layer = wall_passes(replace(POCKET, outside=open_side), LEVEL, WAY)
    assert layer is not None
    (cut,) = layer.passes
    assert not cut.is_closed
    assert chain_length(cut.chain) == pytest.approx(3 * 30.0)


def test_lifted_strokes_to_and_fro_change_their_sense(job: ToolPathTask) -> None:
    way = replace(WAY, covering=Covering.TO_AND_FRO, is_lifted=True, step=10.0)
    strokes = [cut for cut in cleared(job, POCKET, way).passes if not cut.is_closed]
    senses = [cut.chain[0].along(0.0).real for cut in strokes]
    assert senses == pytest.approx([1.0, -1.0, 1.0, -1.0])
    one_way = replace(way, covering=Covering.ONE_WAY)
    strokes = [cut for cut in cleared(job, POCKET, one_way).passes if not cut.is_closed]
    assert [cut.chain[0].along(0.0).real for cut in strokes] == pytest.approx([1.0] * 4)


def test_strokes_begin_on_the_side_that_the_step_comes_from(job: ToolPathTask) -> None:
    way = replace(WAY, covering=Covering.ONE_WAY, is_lifted=True)
    left = cleared(job, FACE, way).passes
    right = cleared(job, FACE, replace(way, steps_left=False)).passes
    assert left[0].start.imag < left[-1].start.imag
    assert right[0].start.imag > right[-1].start.imag


def test_strokes_of_a_face_go_the_tool_and_two_millimetres_beyond_it(job: ToolPathTask) -> None:
    way = replace(WAY, covering=Covering.ONE_WAY, is_lifted=True)
    cut = cleared(job, FACE, way).passes[0]
    assert cut.start.real == pytest.approx(-7.0)
    assert cut.end.real == pytest.approx(47.0)
