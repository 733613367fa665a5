"""Numbers that no machine can mean are refused, with the units that would make sense."""

import re
from pathlib import Path

import pytest

from service.verbs.optimise.program import advise_program as optimise
from stepnc_model.errors import SchemaError, Severity, StepNcError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.plausibility import RULE, implausible, refusal
from stepnc_model.programs.program import Program
from stepnc_model.units import ISO, PROFILES, UnitProfile
from tests.asking import asked_advice
from tests.every_case import every_case

PARTS = Path(__file__).parents[3] / "examples" / "parts"
CORPUS = Path(__file__).parents[4] / "shared" / "corpus" / "iso14649"

TECHNOLOGY_LINE = 10
RIGHT, LEFT = ".RIGHT.", ".LEFT."


def program_of(
    technology: str, *, units: UnitProfile = ISO, hand: str = RIGHT, diameter: str = "10."
) -> Program:
    text = "\n".join([
        "ISO-10303-21;",
        "HEADER;",
        "FILE_SCHEMA(('MACHINING_SCHEMA'));",
        "ENDSEC;",
        "DATA;",
        "#1=PROJECT('P',#2,(),$,$,$);",
        "#2=WORKPLAN('W',(#3),$,$,$);",
        "#3=MACHINING_WORKINGSTEP('S',$,#4,#5,$);",
        "#4=ROUND_HOLE('H',$,(),$,$,$,$,$);",
        f"#6=MILLING_TECHNOLOGY({technology},$);",
        "#5=DRILLING($,$,'OP',5.,$,#7,#6,#10,$,$,$,$,$,$);",
        "#7=MILLING_CUTTING_TOOL('T',#8,(),$,$,$);",
        f"#8=TWIST_DRILL(#9,2,{hand},.F.,$);",
        f"#9=MILLING_TOOL_DIMENSION({diameter},$,$,$,$,$,$);",
        "#10=MILLING_MACHINE_FUNCTIONS(.T.,$,$,.F.,$,(),.T.,$,$,());",
        "ENDSEC;",
        "END-ISO-10303-21;",
    ])
    return Program(Part21File.from_bytes(text.encode()), units=units)


def refused(technology: str, units: UnitProfile = ISO) -> SchemaError:
    program = program_of(technology, units=units)
    error = refusal(program, program.workingsteps)
    assert error is not None
    return error


USUAL = "0.004,.TCP.,$,-20.,$,.F.,.F.,.F."


class TestNumbers:
    def test_usual_numbers_are_plausible(self) -> None:
        program = program_of(USUAL)
        assert implausible(program) == ()
        assert refusal(program, program.workingsteps) is None

    @every_case(
        ("technology", "attribute", "message"),
        [
            ("0.02,.TCP.,$,-301.,$,.F.,.F.,.F.", "spindle", "301 rev/s exceeds 300 rev/s"),
            ("$,.TCP.,25.1,$,0.1,.F.,.F.,.F.", "cutspeed", "25.1 m/s exceeds 25 m/s"),
            ("$,.TCP.,$,-20.,5.1,.F.,.F.,.F.", "feedrate_per_tooth", "exceeds the radius 5 mm"),
            ("1.,.TCP.,$,-20.,$,.F.,.F.,.F.", "feedrate", "25 mm exceeds the radius 5 mm"),
            ("$,.TCP.,$,-20.,0.0004,.F.,.F.,.F.", "feedrate_per_tooth", "below 0.0005 mm"),
            (
                "$,.TCP.,$,-0.25,0.1,.F.,.F.,.F.",
                "spindle",
                "the cutting speed is only 0.471 m/min",
            ),
        ],
    )
    def test_an_implausible_number_is_named_with_its_place(
        self, technology: str, attribute: str, message: str
    ) -> None:
        error = refused(technology)
        assert message in str(error)
        assert error.entity == "#6 MILLING_TECHNOLOGY"
        assert error.attribute == attribute
        assert error.line == TECHNOLOGY_LINE

    @pytest.mark.parametrize(
        "technology",
        [
            "0.02,.TCP.,$,-300.,$,.F.,.F.,.F.",
            "$,.TCP.,10.,$,0.1,.F.,.F.,.F.",
            "$,.TCP.,$,-20.,5.,.F.,.F.,.F.",
            "$,.TCP.,$,-20.,0.0005,.F.,.F.,.F.",
        ],
    )
    def test_the_bounds_themselves_are_plausible(self, technology: str) -> None:
        assert implausible(program_of(technology)) == ()

    def test_a_thread_may_feed_more_than_its_radius(self) -> None:
        assert implausible(program_of("1.,.TCP.,$,-20.,$,.T.,.F.,.F.")) == ()

    def test_a_warning_names_the_rule(self) -> None:
        (finding,) = implausible(program_of("0.02,.TCP.,$,-301.,$,.F.,.F.,.F."))
        assert (finding.severity, finding.rule) == (Severity.WARNING, RULE)

    def test_a_number_that_cuts_nothing_is_an_error(self) -> None:
        (finding,) = implausible(program_of("0.,.TCP.,$,-20.,$,.F.,.F.,.F."))
        assert finding.severity is Severity.ERROR
        assert finding.line == TECHNOLOGY_LINE

    @pytest.mark.parametrize(
        ("hand", "spindle", "severities"),
        [
            (RIGHT, "20.", [Severity.WARNING]),
            (RIGHT, "-20.", []),
            (LEFT, "20.", []),
            ("$", "20.", [Severity.WARNING]),
        ],
    )
    def test_a_right_hand_tool_that_turns_left_is_a_warning(
        self, hand: str, spindle: str, severities: list[Severity]
    ) -> None:
        program = program_of(f"0.004,.TCP.,$,{spindle},$,.F.,.F.,.F.", hand=hand)
        assert [each.severity for each in implausible(program)] == severities
        assert refusal(program, program.workingsteps) is None


class TestTurning:
    """A sample whose rough contour is given another feed per revolution."""

    @staticmethod
    def sample(feed: str) -> Program:
        data = (PARTS / "shaft.stpnc").read_bytes()
        old = b"#302=TURNING_TECHNOLOGY($,.TCP.,#310,0.22,"
        assert old in data
        return Program(
            Part21File.from_bytes(data.replace(old, old[:-5] + feed.encode() + b","))
        )

    def test_no_lathe_feeds_six_millimetres_a_turn(self) -> None:
        (finding,) = implausible(self.sample("6."))
        assert finding.message == "feed 6 mm per revolution"
        assert finding.entity == "#302 TURNING_TECHNOLOGY"
        assert finding.attribute == "feed_per_revolution"

    def test_five_millimetres_a_turn_are_plausible(self) -> None:
        assert implausible(self.sample("5.")) == ()


class TestAdvice:
    def test_rpm_and_mm_per_minute_are_recognised(self) -> None:
        error = refused("240.,.TCP.,$,-1200.,$,.F.,.F.,.F.")
        assert str(error).endswith("plausible with --units rpm-mmin")

    @every_case("name", [name for name in PROFILES if name != "iso"])
    def test_a_program_in_the_profile_named_is_plausible(self, name: str) -> None:
        units = PROFILES[name]
        feed = {"rpm-mmin": "240."}.get(name, "0.1")
        spindle = "-1200." if units.spindle_unit == "rpm" else "-20."
        technology = f"{feed},.TCP.,$,{spindle},$,.F.,.F.,.F."
        assert implausible(program_of(technology, units=units)) == ()

    def test_every_profile_that_is_named_makes_all_numbers_plausible(self) -> None:
        technology = "0.1,.TCP.,$,-1200.,$,.F.,.F.,.F."
        names = str(refused(technology)).partition("--units ")[2].split(" or ")
        assert names == ["rpm-mmtooth", "rpm-mmrev"]
        for name in names:
            program = program_of(technology, units=PROFILES[name])
            assert refusal(program, program.workingsteps) is None

    def test_numbers_that_fit_no_profile_are_said_to(self) -> None:
        error = refused("1.E9,.TCP.,$,-1.E9,$,.F.,.F.,.F.")
        assert str(error).endswith(
            'no unit profile makes all numbers plausible; set it with --set "#6.spindle=VALUE"'
        )

    def test_only_the_workingsteps_asked_for_matter(self) -> None:
        program = program_of("0.02,.TCP.,$,-301.,$,.F.,.F.,.F.")
        assert refusal(program, ()) is None


class TestPublicFiles:
    """University files whose spindles are in rpm."""

    @pytest.mark.parametrize(
        ("name", "number", "fitting"),
        [
            ("FuroBaseConica", "spindle 1000 rev/s", "rpm-mmtooth or rpm-mmrev"),
            ("Ranhura", "spindle 1200 rev/s", "rpm-mmtooth or rpm-mmrev"),
            ("RanhuraPerfilVee", "spindle 1000 rev/s", "rpm-mmtooth or rpm-mmrev"),
            ("testePrecedencias", "spindle 2307.75 rev/s", "rpm-mmtooth or rpm-mmrev"),
            ("furo", "feed per tooth 14.994 mm", "revs-mmtooth or revs-mmrev"),
        ],
    )
    def test_implausible_units_are_refused_with_those_that_fit(
        self, name: str, number: str, fitting: str, tmp_path: Path
    ) -> None:
        path = CORPUS / f"{name}.p21"
        if not path.exists():
            pytest.skip(f"{name}.p21 is not beside the project")
        output = tmp_path / "out.stpnc"
        with pytest.raises(StepNcError) as caught:
            optimise(*asked_advice(file=path, output=output))
        assert number in str(caught.value)
        assert f"plausible with --units {fitting}" in str(caught.value)
        assert re.search(r"line [1-9]\d*: #\d+ MILLING_TECHNOLOGY", str(caught.value))
        assert not output.exists()

    @pytest.mark.parametrize(
        ("name", "units"),
        [
            ("FuroBaseConica", "rpm-mmtooth"),
            ("Ranhura", "rpm-mmrev"),
            ("furo", "revs-mmtooth"),
        ],
    )
    def test_the_units_named_are_not_refused(self, name: str, units: str) -> None:
        path = CORPUS / f"{name}.p21"
        if not path.exists():
            pytest.skip(f"{name}.p21 is not beside the project")
        program = Program.load(path, units=PROFILES[units])
        assert refusal(program, program.workingsteps) is None


@pytest.mark.parametrize("name", ["bracket", "paper002", "shaft"])
def test_the_samples_are_plausible(name: str) -> None:
    program = Program.load(PARTS / f"{name}.stpnc")
    assert refusal(program, program.workingsteps) is None
