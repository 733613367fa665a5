"""A whole program: its order, what is not made, and what goes on all the same."""

from dataclasses import replace
from pathlib import Path

import pytest

from stepnc_model.errors import PathError, SchemaError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.generate import KeptPaths, generate, workingstep_path
from stepnc_model.toolpath.path import Function, ToolPath

PARTS = Path(__file__).parents[3] / "examples" / "parts"
END = "ENDSEC;\nEND-ISO-10303-21;"


def edited(*changes: tuple[str, str], more: str = "", name: str = "bracket") -> Program:
    text = (PARTS / f"{name}.stpnc").read_text()
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    data = text.replace(END, f"{more}\n{END}").encode()
    return Program(Part21File.from_bytes(data, name=name), name=name)


def names(program: Program, faults: list[SchemaError]) -> list[str]:
    return [item.id for item in generate(program, lambda _, fault: faults.append(fault))]


def test_paths_and_functions_come_in_the_order_of_the_program() -> None:
    program = edited()
    items = list(generate(program))
    assert [item.id for item in items if isinstance(item, ToolPath)] == [
        step.id for step in program.workingsteps
    ]
    stop = items[4]
    assert isinstance(stop, Function)
    assert (stop.keyword, stop.id) == ("OPTIONAL_STOP", "LOOK AT THE CLAMPING")


def test_a_path_is_kept_for_its_own_program_and_workingstep_only() -> None:
    program, kept = edited(), KeptPaths()
    step = program.workingsteps[0]
    path = kept(program, step)
    assert kept(program, step) is path
    assert next(generate(program, path_of=kept)) is path
    assert kept(program, replace(step)) is not path
    assert kept(edited(), step) is not path
    few = KeptPaths(most=len(path.steps) - 1)
    assert few(program, step) is not few(program, step)


def test_every_kind_of_operation_finds_its_maker() -> None:
    for name in ("bracket", "shaft"):
        program = edited(name=name)
        for step in program.workingsteps:
            path = workingstep_path(program, step)
            assert path.workingstep == step.ref
            assert path.is_turning == (name == "shaft")


def test_paths_start_where_the_tool_may_come_from() -> None:
    """On the security plane, z = 50 mm for the bracket and 10 mm for the shaft."""
    for name, height in (("bracket", 50.0), ("shaft", 10.0)):
        for item in generate(edited(name=name)):
            if isinstance(item, ToolPath):
                assert item.start[2] == item.end[2] == height


def test_a_fault_ends_the_run_unless_somebody_takes_it() -> None:
    program = edited((
        "#149=TOLERANCED_LENGTH_MEASURE(50.",
        "#149=TOLERANCED_LENGTH_MEASURE(15.",
    ))
    with pytest.raises(SchemaError):
        list(generate(program))
    faults: list[SchemaError] = []
    made = names(program, faults)
    assert "ROUGH POCKET" not in made
    assert "REAM HOLE 2" in made
    assert len(faults) == 2
    assert all(isinstance(fault, PathError) for fault in faults)


@pytest.mark.parametrize(("value", "is_cut"), [("1.", True), ("2.", False), ("$", None)])
def test_a_branch_runs_where_its_condition_is_known(value: str, is_cut: bool | None) -> None:
    more = (
        "#900=IF_STATEMENT('IF',#901,#3,$);\n"
        "#901=COMPARISON_EQUAL(#902,#903);\n"
        f"#902=NC_VARIABLE('A',{value});\n#903=NC_CONSTANT('B',1.);"
    )
    program = edited(("(#3,#7,#4,#5,#6),$,#40,$)", "(#900,#4),$,#40,$)"), more=more)
    faults: list[SchemaError] = []
    made = names(program, faults)
    assert made[-2:] == ["MILL STEP", "MILL SLOT"]
    assert ("ROUGH FACE" in made) == (is_cut is True)
    assert ["#902 NC_VARIABLE" in str(fault) for fault in faults] == [True] * (is_cut is None)


def test_an_unusable_workingstep_says_what_it_lacks() -> None:
    program = edited((
        "#16=MACHINING_WORKINGSTEP('ROUGH POCKET',#43,#140,#206,$)",
        "#16=MACHINING_WORKINGSTEP('ROUGH POCKET',#43,#140,$,$)",
    ))
    faults: list[SchemaError] = []
    names(program, faults)
    assert any("has no operation" in str(fault) for fault in faults)


def test_a_new_setup_stops_the_program() -> None:
    more = (
        "#900=SETUP('SETUP 2',#41,#43,(#901));\n"
        "#901=WORKPIECE_SETUP(#30,#902,$,$,());\n"
        "#902=AXIS2_PLACEMENT_3D('MOVED',#903,#501,#502);\n"
        "#903=CARTESIAN_POINT('',(100.,0.,0.));"
    )
    change = (
        "#6=WORKPLAN('HOLES',(#20,#21,#22,#23,#24,#25),$,$,$)",
        "#6=WORKPLAN('HOLES',(#20,#21,#22,#23,#24,#25),$,#900,$)",
    )
    items = list(generate(edited(change, more=more)))
    stops = [item for item in items if isinstance(item, Function)]
    assert [stop.keyword for stop in stops] == ["OPTIONAL_STOP", "PROGRAM_STOP"]
    assert stops[1].id == "CLAMP FOR SETUP 2"
    hole = next(item for item in items if item.id == "CENTRE HOLE 1")
    assert isinstance(hole, ToolPath)
    # The hole at x = 110 mm of a workpiece that stands 100 mm further.
    assert hole.start[:2] == (210.0, 65.0)


def test_going_straight_down_into_solid_material_is_a_warning() -> None:
    """The open pocket asks for it; the closed one comes down a ramp."""
    program = edited()
    steps = {step.id: step for step in program.workingsteps}
    for name, is_warned in (("ROUGH OPEN POCKET", True), ("ROUGH POCKET", False)):
        texts = [each.message for each in workingstep_path(program, steps[name]).findings]
        assert (
            any(
                "the tool plunges straight into the material: consider a ramp or helix" in text
                for text in texts
            )
            is is_warned
        )


def test_a_feature_beside_the_stock_is_a_warning() -> None:
    program = edited((
        "#142=CARTESIAN_POINT('',(42.,45.,0.));",
        "#142=CARTESIAN_POINT('',(242.,45.,0.));",
    ))
    step = next(step for step in program.workingsteps if step.id == "ROUGH POCKET")
    texts = [str(each) for each in workingstep_path(program, step).findings]
    assert any("outside the stock: x from 212 to 272 mm" in text for text in texts)
