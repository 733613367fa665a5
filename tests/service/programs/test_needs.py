"""Everything that a program lacks is told at once, and doing what is told works."""

import re
from pathlib import Path

import pytest

from benchmarks.end_to_end import filled, run
from tests.stepnc_model.ap238.writer_samples import (
    TOOLS,
    editor_face_inch,
    editor_pocket_nested,
    lathe_face_groove_inch,
    post_two_tools_inch,
)
from tests.stepnc_model.path_only import path_only_text

INSERTS = (
    "number,id,kind,nose_radius_mm,cutting_edge_angle_deg,width_mm,cutting_material\n"
    "1,T0101,turning,0.8,95,,carbide\n3,T0303,grooving,0.2,,3.175,carbide\n"
)


def follow(part: Path, tools: Path | None = None) -> tuple[str, tuple[str, ...]]:
    """Refusal of ``optimise``, and the options that its command names; they must work."""
    out = part.with_name("out.stpnc")
    refused = run("optimise", part, "-o", out)
    assert refused.code == 3
    assert not out.exists()
    options = tuple(filled(f"missing {refused.told}", part.parent, tools))
    done = run("optimise", part, *options, "-o", out)
    assert done.code == 0, done.reason
    assert out.exists()
    return refused.reason, options


def written(folder: Path, text: str) -> Path:
    part = folder / "part.stpnc"
    part.write_bytes(text.encode())
    return part


def test_tools_feed_and_material_are_asked_for_at_once(tmp_path: Path) -> None:
    tools = tmp_path / "tools.csv"
    tools.write_text(TOOLS, encoding="utf-8")
    text, options = follow(written(tmp_path, post_two_tools_inch()), tools)
    assert "a table with tools '1', '4'; a feed (line " in text
    assert options[::2] == ("--tools", "--feed", "--material", "--machine")


def test_a_single_datum_is_named_with_its_place(tmp_path: Path) -> None:
    part = written(tmp_path, editor_pocket_nested())
    assert "names no workpiece material" in run("optimise", part).reason
    part = written(tmp_path, path_only_text())
    assert "#48" not in run("optimise", part, "--material", "c45").reason
    assert "--tools gives a table" in run("optimise", part, "--material", "c45").reason


def test_a_spindle_that_stands_is_given_in_the_unit_of_the_file(tmp_path: Path) -> None:
    text = editor_pocket_nested().replace("NUMERIC_MEASURE(-2400.)", "NUMERIC_MEASURE(0.)")
    part = written(tmp_path, text)
    refused = run("optimise", part)
    assert "in rpm, negative for clockwise" in refused.reason
    _, options = follow(part)
    assert sum(word.endswith(".spindle=-960.") for word in options) == 2
    shown = run("optimise", part, *options, "--dry-run", "--json").out
    assert "960" in shown


def test_a_block_in_another_unit_can_be_replaced(tmp_path: Path) -> None:
    text = editor_face_inch()
    # The same numbers in metres: 4 by 3 by 1 m over paths of some inches.
    foreign = "#9=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));\n"
    head, tail = text.split("DATA;\n")
    tail, count = re.subn(
        r",#\d+\)(REPRESENTATION_ITEM\('(length|width|height)'\))", r",#9)\1", tail
    )
    assert count == 3
    refusal, options = follow(written(tmp_path, f"{head}DATA;\n{foreign}{tail}"))
    assert "in metres, where the tools sweep" in refusal
    assert options[0].startswith("--stock=")


def test_inserts_come_from_a_table(tmp_path: Path) -> None:
    lines = lathe_face_groove_inch().splitlines()
    gone = ("RESOURCE_PROPERTY", "ACTION_RESOURCE_REL", "MACHINING_CUTTING", "MACHINING_TOOL_B")
    kept = [line for line in lines if not line.partition("=")[2].startswith(gone)]
    text = (
        "\n".join(kept).replace("'general turning tool'", "''").replace("'grooving tool'", "''")
    )
    tools = tmp_path / "tools.csv"
    tools.write_text(INSERTS, encoding="utf-8")
    refusal, _ = follow(written(tmp_path, text), tools)
    assert "a table with tools 'T0101', 'T0303'" in refusal


def test_no_unit_profile_is_named_for_units_of_the_file(tmp_path: Path) -> None:
    text = editor_pocket_nested().replace(
        "NUMERIC_MEASURE(-2400.)", "NUMERIC_MEASURE(-2400000.)"
    )
    refused = run("optimise", written(tmp_path, text), "--material", "c45")
    assert "exceeds" in refused.reason
    assert "--units" not in refused.reason
    assert "--set" in refused.reason


@pytest.mark.parametrize("verb", ["check", "toolpath", "canonical", "cycletime"])
def test_the_commands_take_the_table_too(verb: str, tmp_path: Path) -> None:
    tools = tmp_path / "tools.csv"
    tools.write_text(TOOLS.replace("1,facemill", "7,facemill"), encoding="utf-8")
    done = run(verb, written(tmp_path, path_only_text()), "--tools", tools)
    assert done.code == 0, done.reason
    assert "--tools gives" not in done.out


def test_what_no_run_can_follow_is_not_advised(tmp_path: Path) -> None:
    text = editor_pocket_nested()
    plan = "MACHINING_WORKPLAN('Pocket','','','')"
    choice = "MACHINING_PROCESS_EXECUTABLE('Pocket','selective','','')"
    assert plan in text
    text = re.sub(
        r"MACHINING_PROCESS_SEQUENCE_RELATIONSHIP\('','',#12,(#\d+),.*\)",
        r"MACHINING_PROCESS_BRANCH_RELATIONSHIP('','',#12,\1)",
        text.replace(plan, choice),
    )
    part = written(tmp_path, text)
    refused = run("optimise", part, "--material", "c45")
    named = re.search(r'--set "(#\d+\.its_elements=\(#\d+\))"', refused.reason)
    assert named is not None, refused.reason
    assert "advice: no: " in run("check", part).out
    # What the refusal names is done: the program goes the whole way, and keeps its choice.
    advised = tmp_path / "advised.stpnc"
    with_choice = ("--set", named[1], "--material", "c45")
    done = run("optimise", part, *with_choice, "-o", advised)
    assert done.code == 0, done.reason
    assert run("simulate", advised, *with_choice).code == 0
    assert b"BRANCH_RELATIONSHIP" in advised.read_bytes()
    assert run("optimise", advised, "--material", "c45").reason == refused.reason
