"""Passes beside a wall: how many, how far from it, and where they begin."""

from dataclasses import replace
from math import pi
from pathlib import Path

import pytest

from stepnc_model.entities.entity import Entity
from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.milling.contour import chain_length, circle, clockwise, line, polygon
from stepnc_model.toolpath.milling.cover import Flank, leaning, upright
from stepnc_model.toolpath.milling.flank import flank_layer
from stepnc_model.toolpath.milling.layer import CutLevel, Layer
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


WAY = ResolvedStrategy(
    covering=Covering.RINGS,
    step=6.0,
    along=1 + 0j,
    steps_left=True,
    is_lifted=False,
    is_counter_clockwise=True,
    is_inside_out=True,
    has_wall_on_right=True,
)
LEVEL = CutLevel(z=-5.0, above=0.0, cutter=EndMillShape(radius=5.0), allowance=0.5)
REF = Ref[Entity](110)
ROUND = Flank(
    ref=REF, chain=clockwise(circle(75 + 45j, 20.0)), is_closed=True, inset=upright,
    top=0.0, bottom=-10.0, width=15.0,
)  # fmt: skip
EDGE = Flank(
    ref=REF, chain=(line(138 + 90j, 138 + 0j),), is_closed=False, inset=upright,
    top=0.0, bottom=-10.0, width=15.0,
)  # fmt: skip


@pytest.fixture(scope="module")
def job() -> ToolPathTask:
    return job_at("ROUGH CONTOUR")


def layer_of(
    job: ToolPathTask, flank: Flank, way: ResolvedStrategy = WAY, *, is_single: bool = False
) -> Layer:
    layer = flank_layer(job, flank, LEVEL, way, is_single=is_single)
    assert layer is not None
    return layer


def test_passes_come_closer_by_the_step_and_end_at_the_allowance(job: ToolPathTask) -> None:
    """15 mm less 0.5 mm in steps of 6 mm: three passes, the last one 5.5 mm from the wall."""
    found = layer_of(job, ROUND).passes
    radii = [chain_length(cut.chain) / (2.0 * pi) for cut in found]
    assert radii == pytest.approx([20.0 + 5.5 + 12.0, 20.0 + 5.5 + 6.0, 20.0 + 5.5])


def test_what_an_earlier_operation_left_is_taken_off_in_one_pass(job: ToolPathTask) -> None:
    (cut,) = layer_of(job, ROUND, is_single=True).passes
    assert chain_length(cut.chain) == pytest.approx(51.0 * pi)


def test_wall_is_on_the_right_or_on_the_left(job: ToolPathTask) -> None:
    way = replace(WAY, has_wall_on_right=False)
    for found, side in ((layer_of(job, ROUND), 1.0), (layer_of(job, ROUND, way), -1.0)):
        edge = found.passes[-1].chain[0]
        outward = edge.start - (75 + 45j)
        assert (outward / edge.along(0.0)).imag * side > 0.0
        assert found.room.side == 1j * side


def test_open_wall_is_run_over_by_the_radius_and_two_millimetres(job: ToolPathTask) -> None:
    cut = layer_of(job, EDGE).passes[-1]
    assert cut.start == pytest.approx(143.5 + 97j)
    assert cut.end == pytest.approx(143.5 - 7j)


def test_leaning_wall_keeps_the_tool_further_away_below(job: ToolPathTask) -> None:
    """5 mm below the top at 45°: 5 mm further."""
    flank = Flank(
        ref=REF, chain=ROUND.chain, is_closed=True, top=0.0, bottom=-10.0, width=15.0,
        inset=leaning(depth=10.0, slope_deg=45.0),
    )  # fmt: skip
    cut = layer_of(job, flank).passes[-1]
    assert chain_length(cut.chain) == pytest.approx(2.0 * pi * 30.5)


def test_room_is_what_keeps_the_distance_from_the_wall(job: ToolPathTask) -> None:
    room = layer_of(job, ROUND).room
    assert room.clearance(75 + 45j + 27.5) == pytest.approx(2.0)
    assert room.clearance(75 + 45j + 23.5) == pytest.approx(-2.0)


def test_closed_pass_begins_in_the_middle_of_the_longest_line(job: ToolPathTask) -> None:
    outline = clockwise(polygon([0j, 150 + 0j, 150 + 90j, 90j]))
    flank = Flank(
        ref=REF, chain=outline, is_closed=True, inset=upright, top=0.0, bottom=-10.0, width=1.0
    )
    start = layer_of(job, flank).passes[-1].start
    assert start.real == pytest.approx(75.0)
    assert abs(start.imag - 45.0) == pytest.approx(45.0 + 5.5)


def test_passes_before_the_last_one_stay_where_the_stock_is() -> None:
    """The stock goes 3 mm beyond the contour: rings further out only at its corners."""
    job = job_at("ROUGH CONTOUR")
    flank = Flank(
        ref=REF, chain=clockwise(circle(75 + 45j, 45.0)), is_closed=True, inset=upright,
        top=0.0, bottom=-10.0,
    )  # fmt: skip
    *before, last = layer_of(job, flank).passes
    assert last.is_closed
    assert any(not cut.is_closed for cut in before)


def test_too_many_passes_are_refused_with_their_number(job: ToolPathTask) -> None:
    way = replace(WAY, step=0.001)
    with pytest.raises(PathError, match=r"#110 .*14500 passes of 0.001 mm"):
        layer_of(job, ROUND, way)
