"""``check`` says what a program is usable for, and every command gives the same warnings."""

import json
from pathlib import Path

import pytest

from service.cli.main import main
from service.verbs.check.uses import UseName
from stepnc_model.errors import Severity
from tests.checked import check
from tests.service.test_keep_going import FAULTS, NO_FEED, program

CORPUS = Path(__file__).parents[5] / "shared" / "corpus" / "iso14649"
PARTS = Path(__file__).parents[4] / "examples" / "parts"
OK, BAD_INPUT, INFEASIBLE = 0, 3, 4
COMMANDS = (
    ("check",),
    ("toolpath",),
    ("post", "--control", "linuxcnc"),
    ("simulate", "--machine", "vmc15", "--material", "c45"),
    ("optimise", "--machine", "vmc15", "--material", "c45", "--dry-run"),
    ("control", "--machine", "vmc15", "--material", "c45"),
)


def run(*words: object) -> object:
    with pytest.raises(SystemExit) as stopped:
        main([str(word) for word in words])
    return stopped.value.code


def uses(path: Path) -> dict[str, bool]:
    return {use.name.value: use.is_possible for use in check(path).uses}


class TestUses:
    def test_a_sample_is_usable_for_everything(self) -> None:
        assert uses(PARTS / "paper002.stpnc") == dict.fromkeys(map(str, UseName), True)

    def test_without_feed_there_are_tool_paths_only(self, tmp_path: Path) -> None:
        path = tmp_path / "part.stpnc"
        path.write_bytes(program(**NO_FEED))
        contents = check(path)
        assert uses(path) == {
            "tool paths": True, "NC code": False, "simulation": False, "advice": False,
        }  # fmt: skip
        assert all("neither feedrate" in use.reason for use in contents.uses[1:])
        assert not contents.is_usable
        assert contents.is_of_use

    def test_without_material_it_is_usable_when_one_is_named(self, tmp_path: Path) -> None:
        path = tmp_path / "part.stpnc"
        path.write_bytes(program().replace(b"#6=WORKPIECE('W',#8,", b"#6=WORKPIECE('W',$,"))
        contents = check(path)
        by_name = {use.name: use for use in contents.uses}
        assert by_name[UseName.CODE].is_possible
        assert not by_name[UseName.ADVICE].is_possible
        assert by_name[UseName.ADVICE].is_possible_with_material
        assert "--material" in by_name[UseName.ADVICE].reason
        assert contents.is_usable

    @pytest.mark.parametrize("fault", FAULTS)
    def test_what_optimise_and_post_refuse_is_not_usable(
        self, fault: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        path = tmp_path / "part.stpnc"
        path.write_bytes(program(**FAULTS[fault]))
        contents = check(path)
        by_name = {use.name: use.is_possible for use in contents.uses}
        assert by_name[UseName.ADVICE] is (run("optimise", path, "--dry-run") == OK)
        assert by_name[UseName.CODE] is (run("post", path, "--control", "fanuc") == OK)
        assert run("check", path) == (OK if any(by_name.values()) else BAD_INPUT)
        capsys.readouterr()

    @pytest.mark.parametrize("name", ["Cavidade.p21", "nine_workingsteps.p21", "ex1.stp"])
    def test_public_files(
        self, name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        path = CORPUS / name
        if not path.exists():
            pytest.skip(f"{name} is not beside the project")
        found = uses(path)
        code = run("post", path, "--control", "linuxcnc", "-o", tmp_path / "out.ngc")
        assert found["NC code"] is (code == OK)
        code = run("optimise", path, "--dry-run", "--material", "c45")
        assert found["advice"] is (code in {OK, INFEASIBLE})
        capsys.readouterr()

    def test_json_lists_the_uses(
        self, tmp_path: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        path = tmp_path / "part.stpnc"
        path.write_bytes(program(**NO_FEED))
        run("check", path, "--json")
        found = json.loads(capsys.readouterr().out)
        assert found["is_usable"] is False
        assert [use["name"] for use in found["uses"]] == list(map(str, UseName))


def warned(data: bytes) -> bytes:
    """Two holes with everything that all commands warn of."""
    return (
        data.replace(b"#7=SETUP('S',#10,$,", b"#7=SETUP('S',#10,#97,")
        .replace(
            b"ENDSEC;\nEND-ISO",
            b"#97=PLANE('',#98);\n#98=AXIS2_PLACEMENT_3D('',#99,$,$);\n"
            b"#99=CARTESIAN_POINT('',(0.,0.,20.));\nENDSEC;\nEND-ISO",
        )
        .replace(b"(50.,30.,30.)", b"(500.,30.,30.)")
        .replace(b"#52=TWIST_DRILL(#54,2,.RIGHT.", b"#52=TWIST_DRILL(#54,2,.LEFT.")
        .replace(b"'OP AFTER',10.,$,#50,#62,#63,$,$", b"'OP AFTER',10.,$,#50,#62,#63,$,18.")
    )  # fmt: skip


EXPECTED = (
    "security plane z = 20 mm",
    "lies outside the stock",
    "the spindle turns clockwise, but the tool is left-handed",
    "18 mm is deeper than the hole depth of 15 mm",
)


def warnings_of(error: str) -> list[str]:
    return [line for line in error.splitlines() if line.startswith("warning: ")]


@pytest.mark.parametrize("text", EXPECTED)
def test_each_remark_is_a_warning(text: str, tmp_path: Path) -> None:
    path = tmp_path / "part.stpnc"
    path.write_bytes(warned(program()))
    found = [each for each in check(path).remarks if text in each.message]
    assert found
    assert {each.severity for each in found} == {Severity.WARNING}


def test_a_program_without_such_a_fault_has_none_of_them(tmp_path: Path) -> None:
    path = tmp_path / "part.stpnc"
    path.write_bytes(program())
    messages = [each.message for each in check(path).remarks]
    assert not [text for text in EXPECTED if any(text in message for message in messages)]


def test_all_commands_give_the_same_warnings_once_on_stderr(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "part.stpnc"
    path.write_bytes(warned(program()))
    told = {}
    for command, *options in COMMANDS:
        run(command, path, *options)
        out, error = capsys.readouterr()
        told[command] = warnings_of(error)
        assert len(told[command]) == len(set(told[command]))
        assert not set(told[command]) & set(out.splitlines())
    assert told["check"]
    # What is posted leaves the project: all that the table of `check` lists is told with it.
    posted = told.pop("post")
    assert all(texts == told["check"] for texts in told.values()), told
    assert set(told["check"]) <= set(posted)


def test_a_program_without_stock_says_so(tmp_path: Path) -> None:
    path = tmp_path / "part.stpnc"
    path.write_bytes(
        program().replace(
            b"#6=WORKPIECE('W',#8,0.01,$,$,#9,", b"#6=WORKPIECE('W',#8,0.01,$,$,$,"
        )
    )
    texts = [each.message for each in check(path).remarks]
    assert any("no stock is known" in text for text in texts)


class TestCourseOfTravel:
    """A slot whose straight course is placed with its axis across the tool's."""

    AXIS = b"#55=DIRECTION('',(0.0,0.0,1.0));\n#56=DIRECTION('',(1.0,0.0,0.0));"

    def test_it_is_used_where_its_direction_stays_in_the_plane(self, tmp_path: Path) -> None:
        source = CORPUS / "Ranhura.p21"
        if not source.exists():
            pytest.skip("Ranhura.p21 is not beside the project")
        data = source.read_bytes().replace(b"\r\n", b"\n")
        assert self.AXIS in data
        turned = self.AXIS.replace(b"(0.0,0.0,1.0)", b"(1.0,0.0,0.0)").replace(
            b"#56=DIRECTION('',(1.0,0.0,0.0))", b"#56=DIRECTION('',(0.0,1.0,0.0))"
        )
        path = tmp_path / "part.p21"
        # The x axis of the turned placement is the old y, along which the course runs.
        data = data.replace(self.AXIS, turned).replace(
            b"VERTICAL',(0.0,1.0,0.0)", b"VERTICAL',(1.0,0.0,0.0)"
        )
        path.write_bytes(data)
        contents = check(path)
        assert uses(path)["tool paths"]
        assert any("is not the tool's" in each.message for each in contents.remarks)
