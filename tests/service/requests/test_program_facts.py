"""Every command that reads a program takes the same data beyond its file, and writes none."""

from pathlib import Path

import pytest

from service.cli.main import main
from service.inputs.numbers import feed_in
from service.programs.reading import user_data
from service.requests.program_facts import ProgramRequest
from stepnc_model.editing.user_data import completed
from stepnc_model.editing.withdrawal import without_user_data
from stepnc_model.errors import StepNcError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.programs.technology import programmed
from stepnc_model.units import PROFILES, FeedUnit
from tests.every_case import every_case
from tests.service.test_keep_going import NO_DEPTH, NO_FEED, NO_TEETH, program

OK, BAD_INPUT = 0, 3
WITH = "--machine", "vmc15"
COMMANDS: dict[str, tuple[str, ...]] = {
    "check": (),
    "toolpath": (),
    "post": ("--control", "linuxcnc"),
    "simulate": WITH,
    "optimise": (*WITH, "--dry-run"),
    "control": WITH,
    "cycletime": WITH,
}
OPTIONS = ("--units", "--stock", "--set", "--teeth", "--feed")


def run(*words: object) -> object:
    with pytest.raises(SystemExit) as stopped:
        main([str(word) for word in words])
    return stopped.value.code


@every_case("command", [*COMMANDS, "calibrate", "verify", "agent"])
def test_each_command_has_all_options(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(command, "--help") == OK
    shown = capsys.readouterr().out.replace("[", " ").split()
    assert set(OPTIONS) <= set(shown)


@pytest.mark.parametrize("command", ["toolpath", "post", "simulate", "optimise", "control"])
def test_each_command_that_can_leave_out_a_workingstep_does(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    part = tmp_path / "part.stpnc"
    part.write_bytes(program(**NO_DEPTH))
    assert run(command, part, *COMMANDS[command]) == BAD_INPUT
    refused = capsys.readouterr().err
    assert "ROUND_HOLE.depth" in refused
    assert run(command, part, *COMMANDS[command], "--keep-going") == BAD_INPUT
    told = capsys.readouterr().err
    assert "'BAD'" in told
    assert "error" not in told


@pytest.mark.parametrize("command", COMMANDS)
def test_what_is_missing_can_be_given_to_each(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A hole without depth, a technology without feed, a drill without teeth, no raw part."""
    part = tmp_path / "part.stpnc"
    data = program(**NO_DEPTH, **NO_FEED, **NO_TEETH)
    data = data.replace(b"#6=WORKPIECE('W',#8,0.01,$,$,#9,", b"#6=WORKPIECE('W',#8,0.01,$,$,$,")
    part.write_bytes(data)
    given = (
        "--set", "#31.depth=12", "--feed", "0.1mm/tooth", "--teeth", "T2=2",
        "--stock", "-1,-1,0,100,60,30",
    )  # fmt: skip
    run(command, part, *COMMANDS[command])
    before = capsys.readouterr()
    assert "error" in before.out + before.err
    assert run(command, part, *COMMANDS[command], *given) == OK
    after = capsys.readouterr()
    assert "error" not in after.out + after.err
    assert part.read_bytes() == data


def test_nc_code_is_given_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code = tmp_path / "part.ngc"
    code.write_text("G21 G90\nG1 X1 F100\nM2\n")
    assert run("check", code) == OK
    assert run("check", code, "--feed", "240") == BAD_INPUT
    assert "--feed cannot be used with NC code" in capsys.readouterr().err


class TestFeed:
    @pytest.mark.parametrize(
        ("text", "value", "unit"),
        [
            ("240", 4.0, FeedUnit.MM_PER_MINUTE),
            ("240 mm/min", 4.0, FeedUnit.MM_PER_MINUTE),
            ("0.004m/s", 4.0, FeedUnit.METRES_PER_SECOND),
            ("0.1mm/tooth", 0.1, FeedUnit.MM_PER_TOOTH),
            ("2e-1 mm/rev", 0.2, FeedUnit.MM_PER_REVOLUTION),
        ],
    )
    def test_it_has_a_unit(self, text: str, value: float, unit: FeedUnit) -> None:
        found = feed_in(text)
        assert found.value == pytest.approx(value)
        assert found.unit is unit

    @every_case(
        ("text", "message"),
        [
            ("fast", "expected a number in mm/min, or with a unit: m/s"),
            ("0,1mm/tooth", "expected a number"),
            ("10 in/min", "expected a number"),
            ("nan", "must be above 0 to 120000 mm/min"),
            ("-1", "must be above 0 to 120000 mm/min"),
            ("inf m/s", "must be above 0 to 2 m/s"),
            ("101mm/rev", "must be above 0 to 100 mm/rev"),
        ],
    )
    def test_a_bad_one_is_refused_with_its_bound(self, text: str, message: str) -> None:
        with pytest.raises(StepNcError, match=message):
            feed_in(text)

    @every_case(
        ("text", "units", "feed"),
        [
            ("0.1mm/tooth", "iso", 0.1),
            ("0.2mm/rev", "iso", 0.1),
            ("0.1mm/tooth", "rpm-mmin", 0.1),
            ("0.1mm/tooth", "revs-mmtooth", 0.1),
            ("0.2mm/rev", "revs-mmrev", 0.1),
            ("0.2mm/rev", "revs-mmtooth", 0.1),
            ("192", "iso", 0.1),
        ],
    )
    @every_case("written", ["$", "0."])
    def test_a_tooth_takes_it_in_every_unit(
        self, text: str, units: str, feed: float, written: str
    ) -> None:
        """The drill has two teeth and turns at 16 rev/s: 3.2 mm/s are 192 mm/min."""
        technology = f"#61=MILLING_TECHNOLOGY({written},.TCP.,$,-16.,$,.F.,.F.,.F.,$);"
        data = program(_61=technology)
        read = Program(Part21File.from_bytes(data), units=PROFILES[units])
        whole = completed(read, user_data(ProgramRequest(feed=text)))
        step = whole.program.workingsteps[1]
        found = programmed(whole.program, step.technology_ref)
        assert found.feed_per_tooth(16.0, 2) == pytest.approx(feed)
        assert without_user_data(whole.program, whole) == data

    def test_a_feed_by_time_needs_a_file_that_has_such_feeds(self) -> None:
        data = program(**NO_FEED)
        read = Program(Part21File.from_bytes(data), units=PROFILES["revs-mmtooth"])
        with pytest.raises(StepNcError, match=r"in mm/tooth: .* as --feed 0.1mm/tooth"):
            completed(read, user_data(ProgramRequest(feed="240")))

    def test_a_feed_per_turn_needs_the_number_of_teeth(self) -> None:
        read = Program(Part21File.from_bytes(program(**NO_FEED, **{
            "_53": "#53=TWIST_DRILL(#54,$,.RIGHT.,.F.,$);"
        })))  # fmt: skip
        words = ProgramRequest(feed="0.2mm/rev")
        with pytest.raises(StepNcError, match=r'give it with --teeth "T2=N"'):
            completed(read, user_data(words))
        assert completed(read, user_data(ProgramRequest(feed="0.2mm/rev", teeth=("T2=2",))))
