"""The plunge feed from the advice to the machine: file, NC code, run, command line."""

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

from optimiser.advice import Advice
from service.cli.main import main, optimise_main
from service.programs.reading import read_program
from service.programs.toolpaths import nc_lines, paths_of, with_feeds
from service.simulation.confirmation import ConfirmedStep
from service.verbs.optimise import program as advising
from service.verbs.optimise.plan_result import ProgramAdvice
from stepnc_model.editing import writeback
from stepnc_model.editing.file_profile import FileProfile, RecordChoice
from stepnc_model.post.dialect import Dialect
from tests.asking import asked_advice

PARTS = Path(__file__).parents[2] / "examples" / "parts"
STEPS = ("ROUGH OPEN POCKET", "FINISH OPEN POCKET")
TOOLS = """
[[tool]]
number = 1
id = "END MILL 10MM"
kind = "endmill"
diameter_mm = 10
centre_cutting = {}
"""
OK, BAD_INPUT, LIMIT_EXCEEDED = 0, 3, 5


@pytest.fixture(scope="module")
def part(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The face of the bracket, and its open pocket, which is entered straight down."""
    text = (PARTS / "bracket.stpnc").read_text(encoding="ascii")
    whole = "'MAIN WORKPLAN',(#3,#7,#4,#5,#6)"
    assert whole in text
    path = tmp_path_factory.mktemp("part") / "part.stpnc"
    path.write_text(text.replace(whole, "'MAIN WORKPLAN',(#10,#11,#18,#19)"), encoding="ascii")
    return path


@pytest.fixture(scope="module")
def outcome(part: Path) -> ProgramAdvice:
    return advising.advise_program(*asked_advice(file=part, machine="vmc15", confirm=True))


def written(outcome: ProgramAdvice) -> Path:
    assert outcome.written is not None
    return outcome.written


def advices(outcome: ProgramAdvice) -> dict[str, Advice]:
    found = {each.workingstep.id: each for each in outcome.plan.advices}
    return {name: found[name] for name in STEPS}


def advised(outcome: ProgramAdvice) -> dict[str, float]:
    """Feed per tooth straight down, mm."""
    found = {}
    for name, each in advices(outcome).items():
        assert each.after is not None
        assert each.after.setting.plunge_feed is not None
        found[name] = each.after.setting.plunge_feed
    return found


def pockets(outcome: ProgramAdvice) -> list[ConfirmedStep]:
    assert outcome.confirmation is not None
    return [step for step in outcome.confirmation.steps if step.id in STEPS]


def test_plan_and_run_agree_in_time_thrust_and_power_of_a_plunge(
    outcome: ProgramAdvice,
) -> None:
    for step in pockets(outcome):
        of = {each.key: each for each in step.figures}
        assert of["time_s"].simulated == pytest.approx(of["time_s"].promised, rel=0.01)
        assert of["thrust_n"].promised > 400.0
        assert of["thrust_n"].simulated == pytest.approx(of["thrust_n"].promised, rel=0.05)
        for key in ("cutting_power_w", "drive_power_w", "cutting_force_n"):
            assert of[key].simulated == pytest.approx(of[key].promised, rel=0.05), (
                step.id,
                key,
            )


@pytest.mark.parametrize("profile", list(FileProfile))
def test_the_record_carries_it_in_either_profile(
    outcome: ProgramAdvice, tmp_path: Path, profile: FileProfile
) -> None:
    converted = tmp_path / "converted.stpnc"
    program = read_program(written(outcome), units="iso")
    converted.write_bytes(writeback.convert(program, profile))
    records = writeback.records(read_program(converted, units="iso"))
    told = [record.plunge_feed_per_tooth for record in records.values()]
    assert told[:2] == [None, None]
    assert told[2:] == pytest.approx(list(advised(outcome).values()))


def test_advice_that_was_taken_is_given_again(outcome: ProgramAdvice, tmp_path: Path) -> None:
    output = tmp_path / "again.stpnc"
    again = advising.advise_program(
        *asked_advice(file=written(outcome), machine="vmc15", output=output)
    )
    for name, each in advices(again).items():
        assert each.before is not None
        assert each.after is not None
        assert each.before.setting.plunge_feed == pytest.approx(advised(outcome)[name])
        assert each.before.time == pytest.approx(each.after.time)
    assert advised(again) == pytest.approx(advised(outcome))


@pytest.mark.parametrize("control", list(Dialect))
def test_the_code_of_every_control_feeds_slower_down_and_as_the_cut_after_it(
    outcome: ProgramAdvice, control: Dialect
) -> None:
    program = read_program(written(outcome), units="iso")
    paths = with_feeds(paths_of(program, tell=lambda _: None), keep_going=False)
    code = "\n".join(nc_lines(paths, control))
    begin = code.index(STEPS[0])
    part = code[begin : code.index(STEPS[1], begin)]
    feeds = [float(each) for each in re.findall(r"(?:F|RATE\()\s*([\d.]+)", part)]
    state = advices(outcome)[STEPS[0]].after
    assert state is not None
    assert state.plunge_feed is not None
    cut, down = 60.0 * state.feed, 60.0 * state.plunge_feed
    assert feeds[:3] == pytest.approx([cut, down, cut], rel=1e-2)


def test_tables_and_json_show_it(part: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stopped:
        optimise_main([str(part), "--machine", "vmc15", "--dry-run"])
    assert stopped.value.code == OK
    shown = capsys.readouterr().out
    assert "plunge mm/min" in shown
    assert "plunge feed: feed per tooth straight down 0.025 mm reaches its bound" in shown
    with pytest.raises(SystemExit):
        optimise_main([str(part), "--machine", "vmc15", "--dry-run", "--json"])
    face, _, rough, _ = json.loads(capsys.readouterr().out)["workingsteps"]
    assert (face["plunge"], face["advised"]["plunge_feed_mm_min"]) == (None, None)
    assert rough["advised"]["plunge_feed_per_tooth_mm"] == pytest.approx(0.025)
    assert rough["programmed"]["plunge_feed_mm_min"] == rough["programmed"]["feed_mm_min"]
    assert rough["plunge"]["fault"] is None
    names = {limit["name"] for limit in rough["plunge"]["limits"]}
    assert names >= {"feed_per_tooth", "cutting_force", "motor_power"}


@pytest.mark.parametrize(
    ("says", "options", "code"),
    [
        ("false", [], LIMIT_EXCEEDED),
        ("false", ["--allow-plunge"], OK),
        ("true", [], OK),
        ('"perhaps"', [], BAD_INPUT),
    ],
)
def test_a_tool_table_says_whether_a_tool_cuts_over_centre(
    part: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    says: str,
    options: list[str],
    code: int,
) -> None:
    table = tmp_path / "tools.toml"
    table.write_text(TOOLS.format(says), encoding="utf-8")
    arguments = [str(part), "--machine", "vmc15", "--dry-run", "--tools", str(table), *options]
    with pytest.raises(SystemExit) as stopped:
        optimise_main(arguments)
    assert stopped.value.code == code
    shown = capsys.readouterr()
    assert ("does not cut over centre" in shown.out) == (says == "false")
    if code == BAD_INPUT:
        assert "centre_cutting" in shown.err
        assert "neither true nor false" in shown.err


def test_a_plunge_feed_that_is_not_positive_is_refused(
    outcome: ProgramAdvice, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = written(outcome).read_text(encoding="ascii")
    wrong, output = tmp_path / "wrong.stpnc", tmp_path / "out.ngc"
    wrong.write_text(text.replace("'stepnc-optimiser',0.025", "'stepnc-optimiser',-0.025"))
    with pytest.raises(SystemExit) as stopped:
        main(["post", str(wrong), "--control", "linuxcnc", "-o", str(output)])
    assert stopped.value.code == BAD_INPUT
    error = capsys.readouterr().err
    assert "plunge feed -0.025 mm/tooth must be positive" in error
    assert "BOTTOM_AND_SIDE_ROUGH_MILLING" in error
    assert not output.exists()


def test_a_file_without_records_says_what_it_loses(part: Path, tmp_path: Path) -> None:
    """The feed at which its NC code plunges is the one that is told."""
    told: list[str] = []
    request, files = asked_advice(file=part, machine="vmc15", output=tmp_path / "out.stpnc")
    plain = advising.advise_program(
        replace(request, records=RecordChoice.NONE), files, tell=told.append
    )
    lost = [text for text in told if "the plunge feed of" in text]
    plunging = [each for each in plain.plan.advices if each.after and each.after.plunge_feed]
    assert len(lost) == len(plunging) > 0
    paths = paths_of(read_program(written(plain), units="iso"))
    feeds = [float(each) for each in re.findall(r"F([\d.]+)", "\n".join(
        nc_lines(paths, Dialect.LINUXCNC)
    ))]  # fmt: skip
    for text in lost:
        assert "only a record can hold it (--records none)" in text
        slow, fast = (float(each) for each in re.findall(r"([\d.]+) mm/min", text))
        assert slow < fast
        assert any(feed == pytest.approx(fast, rel=0.005) for feed in feeds)
        assert not any(feed == pytest.approx(slow, rel=0.005) for feed in feeds)
