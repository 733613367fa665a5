"""The verb ``post``: what it writes, and what it refuses."""

import logging
from pathlib import Path

import pytest

import stepnc
from service.cli.main import main
from service.errors import BAD_INPUT
from stepnc_model.errors import PostError, SchemaError, StepNcError
from stepnc_model.nc.exact_reading import read
from stepnc_model.post.dialect import Dialect
from stepnc_model.toolpath.path import Function

PARTS = Path(__file__).parents[4] / "examples" / "parts"
BRACKET = PARTS / "bracket.stpnc"
SHAFT = PARTS / "shaft.stpnc"


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
    result = stepnc.post(bracket, control=control.value)
    written = bracket.with_suffix(control.suffix)
    lines = written.read_text().splitlines()
    assert str(result) == f"written: {written} ({len(lines)} lines)"
    assert read(lines, control)


def test_unknown_control_is_answered_with_the_known_ones(bracket: Path) -> None:
    with pytest.raises(StepNcError, match="unknown control 'mazak'; known: canonical"):
        stepnc.post(bracket, control="mazak")  # type: ignore[arg-type]


def test_nothing_is_written_when_one_path_cannot_be_made(part: Path) -> None:
    with pytest.raises(SchemaError, match="#140 CLOSED_POCKET"):
        stepnc.post(part, control="fanuc")
    assert [each.name for each in part.parent.iterdir()] == ["part.stpnc"]


def test_keep_going_writes_the_rest_and_still_says_so_by_its_exit_code(part: Path) -> None:
    result = stepnc.post(part, control="fanuc", keep_going=True)
    assert result.exit_code == BAD_INPUT
    assert len(result.record()["left_out"]) == 2
    assert part.with_suffix(".nc").exists()


def test_klartext_for_a_lathe_is_refused_and_leaves_no_file(tmp_path: Path) -> None:
    out = tmp_path / "shaft.h"
    with pytest.raises(PostError):
        stepnc.post(SHAFT, control="heidenhain", output=out)
    assert list(tmp_path.iterdir()) == []


def test_cycles_make_the_program_shorter(bracket: Path) -> None:
    sizes = []
    for cycles in (False, True):
        stepnc.post(bracket, control="fanuc", cycles=cycles)
        sizes.append(len(bracket.with_suffix(".nc").read_text().splitlines()))
    assert sizes[1] < sizes[0]


def test_a_workingstep_without_a_feed_cannot_be_posted_and_others_can(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    text = BRACKET.read_text()
    slow = text.replace("#311=MILLING_TECHNOLOGY(0.0053,", "#311=MILLING_TECHNOLOGY(0.,")
    assert slow != text
    part = tmp_path / "part.stpnc"
    part.write_text(slow)
    with pytest.raises(SchemaError, match="#311 MILLING_TECHNOLOGY"):
        stepnc.post(part, control="fanuc")
    with caplog.at_level(logging.INFO, logger="stepnc"):
        paths = stepnc.post(part, control="fanuc", keep_going=True).paths
    told = [text for text in caplog.messages if text.startswith("left out: ")]
    # Nobody reams a hole that is not drilled.
    assert [item.id for item in paths.items if isinstance(item, Function)] == [
        "LOOK AT THE CLAMPING", "DRILL HOLE 1", "DRILL HOLE 2", "REAM HOLE 1", "REAM HOLE 2",
    ]  # fmt: skip
    assert "left out: 'DRILL HOLE 1': " in told[0]
    assert "left out: 'REAM HOLE 2': " in told[3]
    assert "the feature is not ready: workingstep 'DRILL HOLE 2' was left out" in told[3]
    code = part.with_suffix(".nc").read_text()
    assert "(THIS WORKINGSTEP IS LEFT OUT)" in code


def test_json_says_what_was_written(
    bracket: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "code.ngc"
    words = ["post", str(bracket), "--control", "linuxcnc", "-o", str(output), "--json"]
    with pytest.raises(SystemExit) as ended:
        main(words)
    assert ended.value.code == 0
    shown, told = capsys.readouterr()
    assert f'"written": "{output}"' in shown
    assert f"written: {output} (" in told


def test_nc_code_is_refused_by_name_and_nothing_is_written(tmp_path: Path) -> None:
    code = tmp_path / "part.stpnc"
    code.write_text("G21 G90\nG1 X10 F100\nM2\n")
    with pytest.raises(StepNcError, match=r"part\.stpnc: is NC code: post writes code of STEP"):
        stepnc.post(code, control="fanuc")
    assert [each.name for each in tmp_path.iterdir()] == ["part.stpnc"]
