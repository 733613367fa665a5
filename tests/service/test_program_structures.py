"""Choices, branches, conditions, functions of the control: what advice takes, runs follow."""

import re
from pathlib import Path

import pytest

from benchmarks.end_to_end import run

BRACKET = Path(__file__).parents[2] / "examples" / "parts" / "bracket.stpnc"

CHOICE = "#900=SELECTIVE('CHOICE',(#20,#21));"
BOTH = "#900=PARALLEL('BOTH',(#20,#21));"
CONDITION = (
    "#900=IF_STATEMENT('IF',#901,#20,#21);",
    "#901=COMPARISON_EQUAL(#902,#903);",
    "#902=NC_VARIABLE('PROBED',$);",
    "#903=NC_CONSTANT('ONE',1.);",
)


def part_with(folder: Path, elements: str, *instances: str) -> Path:
    """Holes of the bracket, run by a structure."""
    text = BRACKET.read_text(encoding="ascii").replace("(#3,#7,#4,#5,#6)", elements)
    text = text.replace("ENDSEC;\nEND-ISO", "\n".join((*instances, "ENDSEC;\nEND-ISO")))
    part = folder / "part.stpnc"
    part.write_text(text, encoding="ascii")
    return part


def post(part: Path, *options: str) -> str:
    code = part.with_suffix(".ngc")
    done = run("post", part, "--control", "linuxcnc", "-o", code, *options)
    return code.read_text(encoding="ascii") if code.exists() else done.reason


@pytest.mark.parametrize("instances", [(CHOICE,), (BOTH,), CONDITION])
def test_doing_what_the_refusal_names_leads_from_advice_to_code_and_run(
    instances: tuple[str, ...], tmp_path: Path
) -> None:
    part, out = part_with(tmp_path, "(#900)", *instances), tmp_path / "out.stpnc"
    refused = run("optimise", part, "-o", out)
    assert refused.code == 3
    assert post(part) == refused.reason
    named = re.search(r'--set "([^"]+)"', refused.reason)
    assert named is not None
    given = named[1].replace("VALUE", "1")
    done = run("optimise", part, "--set", given, "-o", out)
    assert done.code == 0, done.reason
    # What was given is not written: the operator still chooses.
    assert instances[0] in out.read_text(encoding="ascii")
    code = post(out, "--set", given)
    assert "(CENTRE HOLE 1)" in code
    assert "(CENTRE HOLE 2)" not in code
    assert run("simulate", out, "--set", given).code == 0


def test_branches_at_the_same_time_are_simulated_one_after_another(tmp_path: Path) -> None:
    part = part_with(tmp_path, "(#900)", BOTH)
    done = run("simulate", part)
    assert done.code == 0
    assert "at the same time; here they run one after another" in done.told
    assert done.out.count("CENTRE HOLE") == 2
    assert "NC code: no" in run("check", part).out
    assert "simulation: yes" in run("check", part).out
    assert run("optimise", part, "--workingstep", "CENTRE HOLE 1", "--dry-run").code == 3
    assert run("optimise", part, "--keep-going", "--dry-run").code == 3


def test_tools_and_marks_need_no_code_of_their_own(tmp_path: Path) -> None:
    functions = ("#900=LOAD_TOOL('L',#440);", "#901=SET_MARK('M');", "#902=UNLOAD_TOOL('U',$);")
    part = part_with(tmp_path, "(#900,#901,#20,#902)", *functions)
    assert run("optimise", part, "--dry-run").code == 0
    assert "not supported" not in post(part)
    assert run("simulate", part).code == 0


@pytest.mark.parametrize(
    "function", ["WAIT_FOR_MARK('W',#901)", "INDEX_TABLE('I',3)", "EXCHANGE_PALLET('E')"]
)
def test_what_no_run_can_follow_is_left_out_where_the_refusal_says_so(
    function: str, tmp_path: Path
) -> None:
    part = part_with(tmp_path, "(#900,#20)", f"#900={function};", "#901=CHANNEL('C');")
    refused = run("optimise", part, "--dry-run").reason
    assert f"#900 {function.partition('(')[0]}: " in refused
    assert refused.endswith("--keep-going leaves it out")
    done = run("optimise", part, "--dry-run", "--keep-going")
    assert done.code == 3
    assert "feed per tooth" in done.out
    assert "(CENTRE HOLE 1)" in post(part, "--keep-going")


def test_a_workingstep_that_runs_twice_cuts_once(tmp_path: Path) -> None:
    part, out = part_with(tmp_path, "(#20,#21,#20)"), tmp_path / "out.stpnc"
    done = run("optimise", part, "-o", out)
    assert done.code == 0
    assert done.out.count("CENTRE HOLE 1: untouched: the tool meets no material") == 1
    assert post(out).count("(CENTRE HOLE 1)") == 2
    again = tmp_path / "again.stpnc"
    assert run("optimise", out, "-o", again).code == 0
    assert again.read_bytes() == out.read_bytes()


SECOND_SETUP = (
    "#900=SETUP('SETUP 2',#41,#43,(#901));",
    "#901=WORKPIECE_SETUP(#30,#902,$,$,());",
    "#902=AXIS2_PLACEMENT_3D('',#903,$,$);",
    "#903=CARTESIAN_POINT('',(100.,0.,0.));",
    "#904=WORKPLAN('TWO',(#21),$,#900,$);",
)


@pytest.mark.parametrize(
    ("elements", "instances", "command"),
    [
        ("(#20,#21)", (), ("optimise", "--along-path", "--dry-run")),
        ("(#20,#904)", SECOND_SETUP, ("simulate",)),
    ],
)
def test_one_id_for_two_workingsteps_is_refused_where_a_run_needs_it(
    elements: str, instances: tuple[str, ...], command: tuple[str, ...], tmp_path: Path
) -> None:
    part = part_with(tmp_path, elements, *instances)
    text = part.read_text(encoding="ascii").replace(
        "STEP('CENTRE HOLE 2'", "STEP('CENTRE HOLE 1'"
    )
    part.write_text(text, encoding="ascii")
    verb, *options = command
    refused = run(verb, part, *options)
    assert refused.code == 3
    assert "'CENTRE HOLE 1' is also the id of #20" in refused.reason
    assert '''--set "#21.its_id='TEXT'"''' in refused.reason
    done = run(verb, part, *options, "--set", "#21.its_id='CENTRE HOLE 2'")
    assert done.code == 0, done.reason


def test_a_feature_above_the_stock_is_put_on_it_by_the_option_that_is_named(
    tmp_path: Path,
) -> None:
    part = part_with(tmp_path, "(#10)")
    text = part.read_text(encoding="ascii")
    assert "#102=CARTESIAN_POINT('',(-3.,-3.,2.));" in text
    part.write_text(text.replace("(-3.,-3.,2.)", "(-3.,-3.,25.)"), encoding="ascii")
    said = run("toolpath", part).told
    named = re.search(r'outside the stock: .*; --set "([^"]+)" puts it .* 23 mm lower', said)
    assert named is not None
    given = ("--set", named[1])
    assert "outside the stock" not in run("toolpath", part, *given).told
    assert run("optimise", part, *given, "--dry-run").code == 0
