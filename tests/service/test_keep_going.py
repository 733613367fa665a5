"""One bad workingstep does not keep the others from advice, nor from NC code."""

import json
import logging
from pathlib import Path

import pytest

import stepnc
from service.cli.main import main, optimise_main
from stepnc_model.ap238.export import to_ap238
from stepnc_model.editing.user_data import GivenData, GivenFeed, completed
from stepnc_model.editing.withdrawal import without_user_data
from stepnc_model.errors import SchemaError
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.programs.technology import programmed
from stepnc_model.units import FeedUnit

HEAD = [
    "ISO-10303-21;",
    "HEADER;",
    "FILE_SCHEMA(('MACHINING_SCHEMA'));",
    "ENDSEC;",
    "DATA;",
]
BAD_INPUT, NOTHING_ADVISED = 3, 6

OTHER = {
    "#31": "#31=ROUND_HOLE('BAD',#6,(),#90,#91,#93,$,#94);",
    "#41": "#41=DRILLING($,$,'OP BAD',10.,$,#51,#61,#63,$,$,$,$,$,$);",
    "#51": "#51=MILLING_CUTTING_TOOL('T2',#53,(),$,$,$);",
    "#53": "#53=TWIST_DRILL(#54,2,.RIGHT.,.F.,$);",
    "#61": "#61=MILLING_TECHNOLOGY(0.004,.TCP.,$,-16.,$,.F.,.F.,.F.,$);",
}


def program(**changed: str) -> bytes:
    """Two holes 60 mm apart, the second one changed."""
    other = {**OTHER, **{f"#{name[1:]}": text for name, text in changed.items()}}
    return "\n".join([
        *HEAD,
        "#1=PROJECT('P',#2,(#6),$,$,$);",
        "#2=WORKPLAN('W',(#3,#4,#5),$,#7,$);",
        "#3=MACHINING_WORKINGSTEP('GOOD',$,#30,#40,$);",
        "#4=MACHINING_WORKINGSTEP('BAD',$,#31,#41,$);",
        "#5=MACHINING_WORKINGSTEP('AFTER',$,#32,#42,$);",
        "#6=WORKPIECE('W',#8,0.01,$,$,#9,());",
        "#7=SETUP('S',#10,$,(#11));",
        "#8=MATERIAL('C45','C45',());",
        "#9=BLOCK('B',#10,120.,60.,30.);",
        "#10=AXIS2_PLACEMENT_3D('',#12,$,$);",
        "#11=WORKPIECE_SETUP(#6,#10,$,$,());",
        "#12=CARTESIAN_POINT('',(0.,0.,0.));",
        "#30=ROUND_HOLE('GOOD',#6,(),#80,#91,#93,$,#94);",
        other["#31"],
        "#32=ROUND_HOLE('AFTER',#6,(),#85,#91,#93,$,#94);",
        "#40=DRILLING($,$,'OP',10.,$,#50,#60,#63,$,$,$,$,$,$);",
        other["#41"],
        "#42=DRILLING($,$,'OP AFTER',10.,$,#50,#62,#63,$,$,$,$,$,$);",
        "#50=MILLING_CUTTING_TOOL('T1',#52,(),$,$,$);",
        other["#51"],
        "#52=TWIST_DRILL(#54,2,.RIGHT.,.F.,$);",
        other["#53"],
        "#54=MILLING_TOOL_DIMENSION(10.,$,$,60.,$,$,$);",
        "#60=MILLING_TECHNOLOGY(0.004,.TCP.,$,-16.,$,.F.,.F.,.F.,$);",
        other["#61"],
        "#62=MILLING_TECHNOLOGY(0.004,.TCP.,$,-16.,$,.F.,.F.,.F.,$);",
        "#63=MILLING_MACHINE_FUNCTIONS(.T.,$,$,.F.,$,(),.T.,$,$,());",
        "#80=AXIS2_PLACEMENT_3D('',#81,$,$);",
        "#81=CARTESIAN_POINT('',(20.,30.,30.));",
        "#85=AXIS2_PLACEMENT_3D('',#86,$,$);",
        "#86=CARTESIAN_POINT('',(50.,30.,30.));",
        "#90=AXIS2_PLACEMENT_3D('',#95,$,$);",
        "#91=PLANE('',#92);",
        "#92=AXIS2_PLACEMENT_3D('',#96,$,$);",
        "#93=TOLERANCED_LENGTH_MEASURE(10.,$);",
        "#94=FLAT_HOLE_BOTTOM();",
        "#95=CARTESIAN_POINT('',(80.,30.,30.));",
        "#96=CARTESIAN_POINT('',(0.,0.,-15.));",
        "ENDSEC;",
        "END-ISO-10303-21;\n",
    ]).encode()  # fmt: skip


NO_FEED = {"_61": "#61=MILLING_TECHNOLOGY($,.TCP.,$,-16.,$,.F.,.F.,.F.,$);"}
NO_DEPTH = {"_31": "#31=ROUND_HOLE('BAD',#6,(),#90,$,#93,$,#94);"}
NO_TEETH = {"_53": "#53=TWIST_DRILL(#54,0,.RIGHT.,.F.,$);"}
FAULTS = {
    "no teeth": NO_TEETH,
    "no depth": NO_DEPTH,
    "no feed": NO_FEED,
    "feed 0": {"_61": "#61=MILLING_TECHNOLOGY(0.,.TCP.,$,-16.,$,.F.,.F.,.F.,$);"},
    "no tool": {"_41": "#41=DRILLING($,$,'OP BAD',10.,$,$,#61,#63,$,$,$,$,$,$);"},
    "no technology": {"_41": "#41=DRILLING($,$,'OP BAD',10.,$,#51,$,#63,$,$,$,$,$,$);"},
    "no feature": {"_31": "#31=CARTESIAN_POINT('',(0.,0.,0.));"},
    "dangling tool": {"_51": "#51=MILLING_CUTTING_TOOL('T2',#999,(),$,$,$);"},
    "spindle in rpm": {"_61": "#61=MILLING_TECHNOLOGY(0.004,.TCP.,$,-960.,$,.F.,.F.,.F.,$);"},
}


@pytest.fixture
def part(tmp_path: Path) -> Path:
    return tmp_path / "part.stpnc"


def optimised(part: Path, *options: str) -> object:
    with pytest.raises(SystemExit) as stopped:
        optimise_main([str(part), "--machine", "vmc15", *options])
    return stopped.value.code


@pytest.mark.parametrize("fault", FAULTS)
def test_the_others_are_advised_and_the_bad_one_stays_as_it_is(
    fault: str, part: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data = program(**FAULTS[fault])
    part.write_bytes(data)
    assert optimised(part) == BAD_INPUT
    capsys.readouterr()
    assert optimised(part, "--keep-going", "--json") == BAD_INPUT
    out, told = capsys.readouterr()
    found = json.loads(out)
    assert [each["id"] for each in found["workingsteps"]] == ["GOOD", "AFTER"]
    (refused,) = found["refused"]
    assert (refused["id"], refused["is_infeasible"]) == ("BAD", False)
    assert refused["reason"] in told
    written = Part21File.from_bytes(part.with_suffix(".optimised.stpnc").read_bytes())
    before = Part21File.from_bytes(data)
    for number in (4, 31, 41, 51, 53, 61):
        old, new = before.span(number), written.span(number)
        assert data[slice(*old)] == written.data[slice(*new)]


def test_a_program_without_faults_is_advised_alike(part: Path) -> None:
    part.write_bytes(program())
    assert optimised(part) == 0
    plain = part.with_suffix(".optimised.stpnc").read_bytes()
    assert optimised(part, "--keep-going") == 0
    assert part.with_suffix(".optimised.stpnc").read_bytes() == plain


class TestNcCode:
    def test_only_what_depends_by_geometry_is_left_out(self, part: Path) -> None:
        part.write_bytes(program(**NO_FEED))
        paths = stepnc.post(part, control="linuxcnc", keep_going=True).paths
        assert [path.id for path in paths.paths] == ["GOOD", "AFTER"]

    def test_a_hole_in_the_same_place_is_left_out_too(
        self, part: Path, caplog: pytest.LogCaptureFixture
    ) -> None:
        """Another feature, but in the material that the first hole would have removed."""
        data = program(**NO_FEED).replace(b"(50.,30.,30.)", b"(82.,30.,30.)")
        part.write_bytes(data)
        with caplog.at_level(logging.INFO, logger="stepnc"):
            paths = stepnc.post(part, control="linuxcnc", keep_going=True).paths
        assert [path.id for path in paths.paths] == ["GOOD"]
        assert any("'BAD' was left out" in text for text in caplog.messages)

    def test_numbers_that_cannot_be_meant_leave_out_their_workingstep(self, part: Path) -> None:
        part.write_bytes(program(**FAULTS["spindle in rpm"]))
        paths = stepnc.post(part, control="linuxcnc", keep_going=True).paths
        assert [path.id for path in paths.paths] == ["GOOD", "AFTER"]


class TestGivenData:
    @pytest.mark.parametrize(
        ("fault", "option"),
        [
            (NO_TEETH, ("--teeth", "T2=2")),
            (NO_DEPTH, ("--set", "#31.depth=12")),
            (NO_FEED, ("--feed", "240")),
            (NO_FEED, ("--set", "#61.feedrate=0.004")),
            (FAULTS["no tool"], ("--set", "#41.its_tool=#51")),
        ],
    )
    def test_what_is_missing_can_be_given(
        self, fault: dict[str, str], option: tuple[str, ...], part: Path
    ) -> None:
        part.write_bytes(program(**fault))
        assert optimised(part, *option) == 0

    def test_it_is_kept_out_of_the_file(self, part: Path) -> None:
        part.write_bytes(program(**NO_DEPTH))
        assert optimised(part, "--set", "#31.depth=12") == 0
        text = part.with_suffix(".optimised.stpnc").read_text()
        assert NO_DEPTH["_31"] in text
        assert text.count("=PLANE(") == 1
        assert "optimisation:mode:" in text

    def test_in_place_it_is_written(self, part: Path) -> None:
        part.write_bytes(program(**NO_TEETH))
        assert optimised(part, "--teeth", "T2=2", "--in-place") == 0
        assert "#53=TWIST_DRILL(#54,2," in part.read_text()

    def test_withdrawn_data_leave_every_byte_as_it_was(self) -> None:
        data = program(**NO_DEPTH)
        whole = completed(
            Program(Part21File.from_bytes(data)), GivenData(values=("#31.depth=12",))
        )
        assert whole.program.file.data != data
        assert without_user_data(whole.program, whole) == data

    def test_a_number_is_replaced_where_it_stands(self) -> None:
        """The plane is moved, the measure keeps its tolerance: no instance is added."""
        data = program().replace(b"LENGTH_MEASURE(10.,$)", b"LENGTH_MEASURE(10.,#95)")
        given = ("#31.depth=12", "#31.diameter=8.5")
        whole = completed(Program(Part21File.from_bytes(data)), GivenData(values=given))
        changed = data.replace(b"(0.,0.,-15.)", b"(0.,0.,-12.)").replace(
            b"MEASURE(10.,#95)", b"MEASURE(8.5,#95)"
        )
        # Three holes share the plane and the measure: one gets its own.
        assert whole.program.file.data != changed
        assert without_user_data(whole.program, whole) == data
        one = data.replace(
            b"#30=ROUND_HOLE('GOOD',#6,(),#80,#91,#93", b"#30=ROUND_HOLE('GOOD',#6,(),#80,$,$"
        )
        one = one.replace(
            b"#32=ROUND_HOLE('AFTER',#6,(),#85,#91,#93", b"#32=ROUND_HOLE('AFTER',#6,(),#85,$,$"
        )
        assert one != data
        whole = completed(Program(Part21File.from_bytes(one)), GivenData(values=given))
        assert whole.program.file.data == one.replace(b"(0.,0.,-15.)", b"(0.,0.,-12.)").replace(
            b"MEASURE(10.,#95)", b"MEASURE(8.5,#95)"
        )
        assert without_user_data(whole.program, whole) == one

    @pytest.mark.parametrize(
        "broken",
        [
            b"#91=PLANE('',$);",
            b"#91=PLANE('',#999);",
            b"#91=CARTESIAN_POINT('',(0.,0.));",
            b"#91=CYLINDRICAL_SURFACE('',#92,3.);",
        ],
    )
    def test_a_depth_that_cannot_be_moved_is_replaced(self, broken: bytes) -> None:
        data = program().replace(b"#91=PLANE('',#92);", broken)
        words = GivenData(values=("#31.depth=12",))
        whole = completed(Program(Part21File.from_bytes(data)), words)
        (given,) = whole.attributes
        assert len(given.added) == 3
        assert without_user_data(whole.program, whole) == data

    def test_a_feed_is_given_to_those_that_have_none(self) -> None:
        whole = completed(
            Program(Part21File.from_bytes(program(**NO_FEED))),
            GivenData(feed=GivenFeed(value=5.0, unit=FeedUnit.MM_PER_MINUTE)),
        )
        feeds = [
            programmed(whole.program, step.technology_ref).feed.value
            for step in whole.program.workingsteps
        ]
        assert feeds == pytest.approx([4.0, 5.0, 4.0])

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("#31.depth", "expected #INSTANCE.attribute=value"),
            ("#31.deep=1", "has no attribute 'deep'"),
            ("#999.depth=1", "does not exist"),
            ("#31.depth=(", "is not a value of Part 21"),
            ("#31.depth=1);#5=X(1", "is not a value of Part 21"),
            ("#31.depth=#93", "is referenced where"),
            ("#61.feedrate='x'", "where a number is required"),
        ],
    )
    def test_bad_values_are_refused(self, text: str, message: str) -> None:
        with pytest.raises(SchemaError, match=message.replace("(", r"\(")):
            completed(Program(Part21File.from_bytes(program())), GivenData(values=(text,)))

    @pytest.mark.parametrize("text", ["T2", "T2=two", "T9=2", "=2"])
    def test_bad_teeth_are_refused(self, text: str) -> None:
        with pytest.raises(SchemaError, match=r"expected TOOL=NUMBER|no tool 'T9'"):
            completed(Program(Part21File.from_bytes(program())), GivenData(teeth=(text,)))


def test_post_keeps_its_exit_code(part: Path) -> None:
    part.write_bytes(program(**NO_FEED))
    with pytest.raises(SystemExit) as stopped:
        main(["post", str(part), "--control", "linuxcnc", "--keep-going"])
    assert stopped.value.code == BAD_INPUT


class TestSharedOperation:
    """GOOD runs the operation of BAD, whose hole has no depth."""

    DATA = program(**NO_DEPTH).replace(
        b"#3=MACHINING_WORKINGSTEP('GOOD',$,#30,#40,$)",
        b"#3=MACHINING_WORKINGSTEP('GOOD',$,#30,#41,$)",
    )

    def test_the_advised_workingstep_gets_a_copy_and_the_other_stays(
        self, part: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        part.write_bytes(self.DATA)
        assert optimised(part, "--keep-going") == BAD_INPUT
        assert "advised" in capsys.readouterr().out
        file = Part21File.from_bytes(part.with_suffix(".optimised.stpnc").read_bytes())
        before = Part21File.from_bytes(self.DATA)
        for number in (4, 31, 41, 51, 61, 63):
            old, new = before.span(number), file.span(number)
            assert self.DATA[slice(*old)] == file.data[slice(*new)]
        found = Program(file)
        good, bad, _ = (step.operation_ref for step in found.workingsteps)
        assert bad == Ref(41)
        assert good != Ref(41)
        feeds = [
            programmed(found, step.technology_ref).feed.value for step in found.workingsteps
        ]
        assert feeds[0] > feeds[1] == 4.0

    def test_of_ap238_it_is_told_that_the_advice_is_not_written(
        self, part: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        part.write_bytes(to_ap238(Part21File.from_bytes(self.DATA)).data)
        assert optimised(part, "--keep-going", "--json") == BAD_INPUT
        out, told = capsys.readouterr()
        text = "the advice for 'GOOD' is not written"
        assert text in told
        assert any(text in each["message"] for each in json.loads(out)["findings"])

    def test_a_copied_technology_is_without_the_given_data(self, part: Path) -> None:
        """Two workingsteps share a technology without a spindle speed, and one is advised."""
        data = program(_61="#61=MILLING_TECHNOLOGY(0.004,.TCP.,$,$,$,.F.,.F.,.F.,$);").replace(
            b"'OP AFTER',10.,$,#50,#62,", b"'OP AFTER',10.,$,#50,#61,"
        )
        part.write_bytes(data)
        options = ("--set", "#61.spindle=-16.", "--workingstep", "BAD")
        assert optimised(part, *options) == 0
        file = Part21File.from_bytes(part.with_suffix(".optimised.stpnc").read_bytes())
        technologies = [file.parameters(id) for id in file.ids_of("MILLING_TECHNOLOGY")]
        lacking = [each for each in technologies if each[3] is None]
        assert len(lacking) == 2
        assert len(technologies) == 4


def test_nothing_to_advise_has_an_exit_code_of_its_own(
    part: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """All three workingsteps lock their feeds."""
    locked = program().replace(b"$,-16.,$,.F.,.F.,.F.", b"$,-16.,$,.F.,.T.,.F.")
    part.write_bytes(locked)
    assert optimised(part) == NOTHING_ADVISED
    assert "nothing was written: no workingstep was advised" in capsys.readouterr().err
    assert [each.name for each in part.parent.iterdir()] == [part.name]
    assert optimised(part, "--dry-run") == NOTHING_ADVISED
    assert optimised(part, "--in-place") == NOTHING_ADVISED
    assert part.read_bytes() == locked
