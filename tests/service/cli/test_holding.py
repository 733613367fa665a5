"""``optimise`` with what holds the workpiece, and with inserts that have wipers."""

import json
from pathlib import Path

import pytest

from optimiser.bounds.chip_load import ROUGH_NOSE_FEED
from service.cli.main import main, optimise_main

ROOT = Path(__file__).parents[3]
CHUCK = ROOT / "examples" / "holding" / "chuck.toml"
LATHE = ROOT / "simulator" / "data" / "machines" / "lathe22.toml"
OK, BAD_INPUT = 0, 3


@pytest.fixture
def shaft(tmp_path: Path) -> Path:
    path = tmp_path / "shaft.stpnc"
    path.write_bytes((ROOT / "examples" / "parts" / "shaft.stpnc").read_bytes())
    return path


def optimise(*arguments: object) -> object:
    """Exit code of ``optimise``."""
    with pytest.raises(SystemExit) as stopped:
        optimise_main([str(each) for each in arguments])
    return stopped.value.code


def test_a_table_bounds_and_json_has_the_loads(
    shaft: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ("--dry-run", "--json", "--workingstep", "ROUGH CONTOUR")
    assert optimise(shaft, *words, "--holding", CHUCK) == OK
    plan = json.loads(capsys.readouterr().out)
    (step,) = plan["workingsteps"]
    bounds = {limit["name"]: limit for limit in step["limits"]}
    torque = bounds["chuck_torque"]
    assert torque["unit"] == "N·m"
    assert torque["value"] == pytest.approx(step["holding_load"]["torque_nm"])
    assert bounds["bar_deflection"]["unit"] == "µm"
    assert set(step["holding_load"]) == {"torque_nm", "moment_nm", "force_n", "lift_n"}
    assert not any("[[holding]]" in finding["message"] for finding in plan["findings"])


def test_a_machine_s_own_file_may_hold(shaft: Path, tmp_path: Path) -> None:
    machine = tmp_path / "mine.toml"
    held = CHUCK.read_text(encoding="utf-8")
    machine.write_text(LATHE.read_text(encoding="utf-8") + held, encoding="utf-8")
    assert optimise(shaft, "--machine", machine, "--workingstep", "FINISH FACE") == OK


def test_a_machine_is_shown_with_what_it_holds_with(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    machine = tmp_path / "mine.toml"
    held = CHUCK.read_text(encoding="utf-8")
    machine.write_text(LATHE.read_text(encoding="utf-8") + held, encoding="utf-8")
    with pytest.raises(SystemExit) as stopped:
        main(["machines", str(machine)])
    assert stopped.value.code == OK
    assert "60 kN at rest, 3 jaws, friction 0.2" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("good", "bad", "message"),
    [
        ("friction = 0.2", "friction = 7", "holding[1].friction: 7 exceeds 1"),
        ('"chuck"', '"glue"', "holding[1].kind: 'glue' is not one of chuck, vice, clamps"),
        ("[[holding]]", "[[hold]]", "hold: unknown key"),
        (
            "jaw_radius_mm = 63\n",
            "",
            "jaw_radius_mm: missing; expected together with jaw_mass_kg",
        ),
    ],
)
def test_a_bad_table_writes_nothing(
    good: str,
    bad: str,
    message: str,
    shaft: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    holding = tmp_path / "holding.toml"
    text = CHUCK.read_text(encoding="utf-8")
    assert good in text
    holding.write_text(text.replace(good, bad), encoding="utf-8")
    assert optimise(shaft, "--holding", holding) == BAD_INPUT
    assert message in capsys.readouterr().err
    assert {path.name for path in tmp_path.iterdir()} == {"shaft.stpnc", "holding.toml"}


def test_a_chuck_that_cannot_be_judged_writes_nothing(
    shaft: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = shaft.read_text(encoding="utf-8").replace("#33,(#36));", "#33,());")
    shaft.write_text(text, encoding="utf-8")
    assert optimise(shaft, "--holding", CHUCK) == BAD_INPUT
    assert "holding.jaw_face_z_mm: missing" in capsys.readouterr().err
    assert not shaft.with_name("shaft.optimised.stpnc").exists()


def test_a_wiper_of_a_tool_table_doubles_the_feed_up_to_the_strength_of_the_nose(
    shaft: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    tools = tmp_path / "tools.toml"
    tools.write_text(
        '[[tool]]\nnumber = 1\nkind = "turning"\nid = "FINISHING TOOL, CARBIDE P15"\n'
        "nose_radius_mm = 0.8\nwiper = true\n",
        encoding="utf-8",
    )
    feeds = []
    for more in ((), ("--tools", tools)):
        words = ("--dry-run", "--json", "--workingstep", "FINISH FACE")
        assert optimise(shaft, *words, *more) == OK
        (step,) = json.loads(capsys.readouterr().out)["workingsteps"]
        feeds.append(step["advised"]["feed_per_tooth_mm"])
    assert feeds[1] == pytest.approx(min(2.0 * feeds[0], ROUGH_NOSE_FEED * 0.8))
