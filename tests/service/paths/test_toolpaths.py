"""The verbs toolpath, post and canonical: what they write, and what they refuse."""

from pathlib import Path

import pytest

from service.cli.main import main, optimise_main
from service.paths.toolpaths import PostRequest, canonical_of, post
from stepnc_model.errors import SchemaError, StepNcError
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.dialects import read
from stepnc_model.toolpath.path import Function

PARTS = Path(__file__).parents[3] / "examples" / "parts"
BRACKET = PARTS / "bracket.stpnc"
SHAFT = PARTS / "shaft.stpnc"
PNG = b"\x89PNG\r\n\x1a\n"

OK, BAD_INPUT = 0, 3


def stepnc(*arguments: object) -> object:
    with pytest.raises(SystemExit) as stopped:
        main([str(each) for each in arguments])
    return stopped.value.code


@pytest.fixture
def part(tmp_path: Path) -> Path:
    """A bracket with a pocket that has no room for its corners."""
    text = BRACKET.read_text()
    narrow = text.replace(
        "#149=TOLERANCED_LENGTH_MEASURE(50.", "#149=TOLERANCED_LENGTH_MEASURE(15."
    )
    assert narrow != text
    path = tmp_path / "part.stpnc"
    path.write_text(narrow)
    return path


@pytest.fixture
def bracket(tmp_path: Path) -> Path:
    path = tmp_path / "bracket.stpnc"
    path.write_bytes(BRACKET.read_bytes())
    return path


@pytest.mark.parametrize("control", list(Dialect))
def test_nc_code_goes_beside_the_program_and_reads_back(
    bracket: Path, control: Dialect
) -> None:
    told: list[str] = []
    post(PostRequest(file=bracket, control=control.value), tell=told.append)
    written = bracket.with_suffix(control.suffix)
    lines = written.read_text().splitlines()
    assert told[-1] == f"written: {written} ({len(lines)} lines)"
    assert read(lines, control)


def test_unknown_control_is_answered_with_the_known_ones(bracket: Path) -> None:
    with pytest.raises(StepNcError, match="unknown control 'mazak'; known: canonical"):
        post(PostRequest(file=bracket, control="mazak"))


def test_nothing_is_written_when_one_path_cannot_be_made(part: Path) -> None:
    assert stepnc("post", part, "--control", "fanuc") == BAD_INPUT
    assert [each.name for each in part.parent.iterdir()] == ["part.stpnc"]


def test_keep_going_writes_the_rest_and_still_says_so_by_its_exit_code(part: Path) -> None:
    assert stepnc("post", part, "--control", "fanuc", "--keep-going") == BAD_INPUT
    assert part.with_suffix(".nc").exists()


def test_klartext_for_a_lathe_is_refused_and_leaves_no_file(tmp_path: Path) -> None:
    out = tmp_path / "shaft.h"
    assert stepnc("post", SHAFT, "--control", "heidenhain", "-o", out) == BAD_INPUT
    assert list(tmp_path.iterdir()) == []


def test_cycles_make_the_program_shorter(bracket: Path) -> None:
    sizes = []
    for cycles in (False, True):
        post(PostRequest(file=bracket, control="fanuc", cycles=cycles))
        sizes.append(len(bracket.with_suffix(".nc").read_text().splitlines()))
    assert sizes[1] < sizes[0]


def test_canonical_commands_of_nc_code_equal_those_of_the_program(bracket: Path) -> None:
    for control in ("linuxcnc", "sinumerik"):
        post(PostRequest(file=bracket, control=control))
    one = list(canonical_of(bracket.with_suffix(".ngc"), control="linuxcnc", is_lathe=False))
    other = list(canonical_of(bracket.with_suffix(".mpf"), control="sinumerik", is_lathe=False))
    feeds = [
        [line for line in each if line.startswith("STRAIGHT_FEED")] for each in (one, other)
    ]
    assert len(feeds[0]) == len(feeds[1]) > 100


def test_a_line_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    code = tmp_path / "part.nc"
    code.write_text("%\nO0001\nG21\nG1 X10. Q?\nM30\n%\n")
    with pytest.raises(StepNcError, match=r"part\.nc: line 4: "):
        list(canonical_of(code, control="fanuc", is_lathe=False))


def test_canonical_prints_commands(bracket: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert stepnc("post", bracket, "--control", "haas") == OK
    assert stepnc("canonical", bracket.with_suffix(".nc"), "--control", "haas") == OK
    assert "PROGRAM_END()" in capsys.readouterr().out


def test_optimise_writes_nc_code_with_the_advised_feeds(tmp_path: Path) -> None:
    part = tmp_path / "paper002.stpnc"
    part.write_bytes((PARTS / "paper002.stpnc").read_bytes())
    with pytest.raises(SystemExit) as stopped:
        optimise_main([str(part), "--machine", "paper002", "--nc", "linuxcnc"])
    assert stopped.value.code == OK
    text = (tmp_path / "paper002.optimised.ngc").read_text()
    # 290.0 mm/min is the advice for the paper's own part: its Table 2 and the README.
    assert "F290\n" in text


def test_nc_code_never_replaces_the_program(tmp_path: Path) -> None:
    part, output = tmp_path / "part.ngc", tmp_path / "part.x"
    part.write_bytes((PARTS / "paper002.stpnc").read_bytes())
    words = [part, "--machine", "paper002", "--nc", "linuxcnc", "-o", output]
    with pytest.raises(SystemExit) as stopped:
        optimise_main([str(word) for word in words])
    assert stopped.value.code == BAD_INPUT
    assert [each.name for each in tmp_path.iterdir()] == ["part.ngc"]


def test_a_workingstep_without_a_feed_cannot_be_posted_and_others_can(tmp_path: Path) -> None:
    text = BRACKET.read_text()
    slow = text.replace("#311=MILLING_TECHNOLOGY(0.0053,", "#311=MILLING_TECHNOLOGY(0.,")
    assert slow != text
    part = tmp_path / "part.stpnc"
    part.write_text(slow)
    with pytest.raises(SchemaError, match="#311 MILLING_TECHNOLOGY"):
        post(PostRequest(file=part, control="fanuc"))
    told: list[str] = []
    paths = post(PostRequest(file=part, control="fanuc", keep_going=True), tell=told.append)
    told = [text for text in told if text.startswith("left out: ")]
    # Nobody reams a hole that is not drilled.
    assert [item.id for item in paths.items if isinstance(item, Function)] == [
        "LOOK AT THE CLAMPING", "DRILL HOLE 1", "DRILL HOLE 2", "REAM HOLE 1", "REAM HOLE 2",
    ]  # fmt: skip
    assert "left out: 'DRILL HOLE 1': " in told[0]
    assert "left out: 'REAM HOLE 2': " in told[3]
    assert "the feature is not ready: workingstep 'DRILL HOLE 2' was left out" in told[3]
    code = part.with_suffix(".nc").read_text()
    assert "(THIS WORKINGSTEP IS LEFT OUT)" in code


def test_optimise_writes_nothing_where_the_control_cannot_do_it(tmp_path: Path) -> None:
    part = tmp_path / "shaft.stpnc"
    part.write_bytes(SHAFT.read_bytes())
    with pytest.raises(SystemExit) as stopped:
        optimise_main([str(part), "--nc", "heidenhain"])
    assert stopped.value.code == BAD_INPUT
    assert [each.name for each in tmp_path.iterdir()] == ["shaft.stpnc"]


def test_a_dry_run_writes_no_nc_code_either(tmp_path: Path) -> None:
    part = tmp_path / "paper002.stpnc"
    part.write_bytes((PARTS / "paper002.stpnc").read_bytes())
    with pytest.raises(SystemExit) as stopped:
        optimise_main([str(part), "--machine", "paper002", "--nc", "fanuc", "--dry-run"])
    assert stopped.value.code == OK
    assert [each.name for each in tmp_path.iterdir()] == ["paper002.stpnc"]
