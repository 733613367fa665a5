"""Settings set into programs: technology and depth change, and nothing else does."""

from itertools import pairwise
from pathlib import Path

import pytest

from stepnc_model.editing.cut_settings import CutSettings, with_settings
from stepnc_model.errors import SchemaError
from stepnc_model.programs.program import Program
from stepnc_model.programs.technology import programmed
from stepnc_model.programs.tool import tool_of
from stepnc_model.toolpath.generate import generate
from stepnc_model.toolpath.path import ToolPath
from tests.every_case import every_case

PARTS = Path(__file__).parents[3] / "examples" / "parts"


def loaded(name: str) -> Program:
    return Program.load(PARTS / f"{name}.stpnc")


def levels(program: Program) -> int:
    """Number of levels of a slot: heights at which the tool moves along."""
    paths = [item for item in generate(program) if isinstance(item, ToolPath)]
    ends = [move.end for path in paths for move in path.moves]
    return len({
        round(there[2], 9)
        for here, there in pairwise(ends)
        if here[2] == there[2] < 0.0 and here[0] != there[0]
    })


def test_feed_speed_and_depth_of_a_slot() -> None:
    program = with_settings(
        loaded("paper003_case1"), CutSettings(feed=62.695, spindle_speed=-13.0768, depth=2.838)
    )
    step = program.workingsteps[0]
    told = programmed(program, step.technology_ref)
    assert told.feed.value == pytest.approx(62.695, rel=1e-11)
    assert told.speed.value == pytest.approx(13.0768, rel=1e-11)
    assert told.speed.scale < 0.0
    assert b"-13.0768" in program.file.data
    assert b"0.062695" in program.file.data


@pytest.mark.parametrize(("depth", "count"), [(1.5, 4), (2.0, 3), (2.5, 3), (3.0, 2), (6.0, 1)])
def test_layers_follow_the_depth(depth: float, count: int) -> None:
    program = with_settings(loaded("paper003_case1"), CutSettings(depth=depth))
    assert levels(program) == count


def test_a_positive_speed_turns_counter_clockwise() -> None:
    program = with_settings(loaded("paper003_case1"), CutSettings(spindle_speed=20.0))
    told = programmed(program, program.workingsteps[0].technology_ref)
    assert told.speed.scale > 0.0


def test_the_values_of_the_file_give_the_file_back() -> None:
    program = loaded("paper003_case1")
    told = programmed(program, program.workingsteps[0].technology_ref)
    same = CutSettings(feed=told.feed.value, spindle_speed=-told.speed.value)
    assert with_settings(program, same).file.data == program.file.data


def test_only_named_workingsteps_change() -> None:
    program = loaded("bracket")
    named = next(
        step.id
        for step in program.workingsteps
        if hasattr(step.operation, "axial_cutting_depth")
    )
    changed = with_settings(program, CutSettings(feed=7.0), [named])
    for before, after in zip(program.workingsteps, changed.workingsteps, strict=True):
        speeds = [
            programmed(each, step.technology_ref)
            for each, step in ((program, before), (changed, after))
        ]
        tool = tool_of(changed, after.tool_ref)
        if before.id == named:
            turning = speeds[1].spindle_speed(tool.diameter)
            feed = speeds[1].feed_per_tooth(turning, tool.teeth) * turning * tool.teeth
            assert feed == pytest.approx(7.0)
        else:
            assert speeds[0].feed.value == speeds[1].feed.value


def test_drilling_stays_as_it_is_unless_named() -> None:
    program = loaded("bracket")
    changed = with_settings(program, CutSettings(feed=7.0, spindle_speed=-15.0))
    drills = [step for step in program.workingsteps if "drill" in step.operation_type]
    assert drills
    for step in drills:
        after = changed.workingsteps[step.index]
        told = [
            programmed(program, step.technology_ref),
            programmed(changed, after.technology_ref),
        ]
        assert told[0].feed.value == told[1].feed.value
        assert told[0].speed.value == told[1].speed.value


@every_case(
    ("settings", "message"),
    [
        ({"feed": 0.0}, "feed 0 must be positive"),
        ({"feed": float("nan")}, "feed nan must be positive"),
        ({"spindle_speed": 0.0}, "spindle speed 0 must not be zero"),
        ({"depth": -1.0}, "depth -1 must be positive"),
    ],
)
def test_impossible_settings_are_refused(settings: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        CutSettings(**settings)


def test_an_unknown_workingstep_is_told() -> None:
    with pytest.raises(SchemaError, match="no workingstep 'SLOT'; known: MILL SLOT"):
        with_settings(loaded("paper003_case1"), CutSettings(feed=1.0), ["SLOT"])


def test_a_lathe_at_constant_cutting_speed_takes_no_spindle_speed() -> None:
    program = loaded("shaft")
    surface = next(
        step.id
        for step in program.workingsteps
        if programmed(program, step.technology_ref).speed.quantity == "cutting speed"
    )
    with pytest.raises(SchemaError, match="the spindle follows the radius"):
        with_settings(program, CutSettings(spindle_speed=-10.0), [surface])
    with pytest.raises(SchemaError, match="no feed in mm/s"):
        with_settings(program, CutSettings(feed=2.0), [surface])


def test_a_drill_has_no_depth_of_passes() -> None:
    program = loaded("bracket")
    drill = next(step.id for step in program.workingsteps if "drill" in step.operation_type)
    with pytest.raises(SchemaError, match="no depth of passes"):
        with_settings(program, CutSettings(depth=2.0), [drill])


def test_a_cutting_speed_cannot_be_reversed() -> None:
    program = loaded("paper002")
    named = program.workingsteps[0].id
    told = programmed(program, program.workingsteps[0].technology_ref)
    assert told.speed.quantity == "cutting speed"
    with pytest.raises(SchemaError, match="cannot be reversed"):
        with_settings(program, CutSettings(spindle_speed=10.0), [named])
    changed = with_settings(program, CutSettings(spindle_speed=-10.0), [named])
    step = changed.workingsteps[0]
    tool = tool_of(changed, step.tool_ref)
    speed = programmed(changed, step.technology_ref).spindle_speed(tool.diameter)
    assert speed == pytest.approx(10.0)
