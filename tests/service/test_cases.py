"""The small inputs that failed once, with the commands of their list: what comes out now.

They lie beside the project; the same kinds of input are written out in the tests of their
rooms, which do not need them.
"""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from service.cli.main import main as stepnc
from service.errors import BAD_INPUT, INFEASIBLE, LIMIT_EXCEEDED, OK
from tests.every_case import every_case

ROOT = Path(__file__).parents[2]
PARTS = ROOT / "examples" / "parts"
CASES = ROOT.parent / "shared" / "cases"
NC, INPUT = CASES / "nc", CASES / "input"
MILL = ("--machine", "vmc15", "--material", "c45")
BLOCK = ("--stock=-20,-20,-20,70,40,0", *MILL)
TOOLS = ("--tools", str(NC / "t6.csv"))
INCHES = ("--stock=-508,-508,-508,1778,1016,0", *MILL)
"""The same numbers, of a program in inches."""

pytestmark = pytest.mark.skipif(not CASES.is_dir(), reason="the cases are not beside this tree")

FEED = re.compile(r"F([0-9.]+)")


def code_of(*words: str | Path) -> int:
    """Exit code of a command."""
    with pytest.raises(SystemExit) as end:
        stepnc([str(word) for word in words])
    assert isinstance(end.value.code, int)
    return end.value.code


def plan_of(capsys: pytest.CaptureFixture[str], *words: str | Path) -> dict[str, Any]:
    """Plan of ``optimise`` as JSON, whatever the exit code."""
    code_of("optimise", *words, "--dry-run", "--json")
    found: dict[str, Any] = json.loads(capsys.readouterr().out)
    return found


def feeds(file: Path, word: str) -> list[float]:
    """Feeds of the blocks of a program that have a word."""
    return [
        float(found[1])
        for line in file.read_text(encoding="utf-8").splitlines()
        if word in line and (found := FEED.search(line))
    ]


class TestLimits:
    @every_case(("part", "material"), [("paper002", "c45_nogroup"), ("bracket", "shop_steel")])
    def test_less_data_give_no_more_feed_and_are_told(
        self, part: str, material: str, capsys: pytest.CaptureFixture[str]
    ) -> None:
        file, words = PARTS / f"{part}.stpnc", ("--machine", "vmc15", "--material")
        known = plan_of(capsys, file, *words, "c45")["workingsteps"]
        found = plan_of(capsys, file, *words, CASES / "advice" / f"{material}.toml")
        for usual, step in zip(known, found["workingsteps"], strict=True):
            if step["status"] == "advised":
                assert step["unchecked"], step["id"]
                feed = step["advised"]["feed_mm_min"]
                # In another depth the feed has other bounds.
                is_alike = step["advised"]["passes"] == usual["advised"]["passes"]
                most = max(
                    (usual["advised"] or usual["programmed"])["feed_mm_min"],
                    step["programmed"]["feed_mm_min"],
                )
                assert feed <= 1.001 * most or not is_alike, step["id"]

    @every_case("material", ["hardened_55hrc", "hardened_60hrc", "chilled_iron"])
    def test_high_speed_steel_in_hard_material_is_refused(
        self, material: str, capsys: pytest.CaptureFixture[str]
    ) -> None:
        words = (PARTS / "paper002.stpnc", "--machine", "vmc15", "--material", material)
        assert code_of("optimise", *words, "--dry-run") == INFEASIBLE
        assert "high-speed steel" in capsys.readouterr().out

    def test_least_time_takes_no_longer_than_least_energy(
        self, capsys: pytest.CaptureFixture[str]
    ) -> None:
        words = (PARTS / "bracket.stpnc", *MILL, "--workingstep", "ROUGH POCKET", "--mode")
        times = [
            plan_of(capsys, *words, mode)["total_time_s"]["after"] for mode in ("TC", "EC")
        ]
        assert times[0] <= times[1] <= 132.0

    def test_the_same_material_goes_and_the_finisher_bends_no_more(
        self, tmp_path: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        file = CASES.parent / "corpus" / "iso14649" / "RanhuraPerfilVee.p21"
        words = (file, "--units", "rpm-mmtooth", "--confirm", "-o", tmp_path / "out.stpnc")
        # 5 for a tool that plunges and does not cut over centre, not for the confirmation.
        assert code_of("optimise", *words, "--json") == LIMIT_EXCEEDED
        plan = json.loads(capsys.readouterr().out)
        assert plan["confirmation"]["passed"] == []


class TestCode:
    def test_a_cycle_that_meets_no_stock_keeps_its_feed(self, tmp_path: Path) -> None:
        out = tmp_path / "out.nc"
        code_of("optimise", NC / "drill_low_stock.nc", *TOOLS, *BLOCK, "-o", out)
        assert feeds(out, "Z5.")[:1] == [200.0]

    @every_case("tools", ["t6.csv", "t6n.csv"])
    def test_a_straight_plunge_keeps_its_feed(self, tools: str, tmp_path: Path) -> None:
        out = tmp_path / "out.nc"
        code_of("optimise", NC / "plunge.nc", "--tools", NC / tools, *BLOCK, "-o", out)
        assert feeds(out, "Z-15.") == [100.0]

    def test_unknown_teeth_are_told(
        self, tmp_path: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        words = (NC / "base.nc", "--tools", NC / "noteeth.csv", *BLOCK)
        code_of("optimise", *words, "-o", tmp_path / "out.nc")
        assert "teeth" in "".join(capsys.readouterr())

    def test_a_rapid_through_the_stock_ends_with_5(
        self, tmp_path: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        out = tmp_path / "out"
        words = (*TOOLS, *BLOCK, "-o")
        assert code_of("optimise", NC / "crash.nc", *words, f"{out}.nc") == LIMIT_EXCEEDED
        assert "rapid" in capsys.readouterr().err
        run = ("simulate", "--nc", NC / "crash.nc", *words, f"{out}.csv")
        assert code_of(*run) == LIMIT_EXCEEDED

    def test_a_second_run_changes_no_byte(self, tmp_path: Path) -> None:
        one, two = tmp_path / "one.nc", tmp_path / "two.nc"
        code_of("optimise", NC / "arc_over_180.nc", *TOOLS, *INCHES, "-o", one)
        assert code_of("optimise", one, *TOOLS, *INCHES, "-o", two) == OK
        assert two.read_bytes() == one.read_bytes()


class TestDamage:
    @every_case("verb", ["check", "toolpath", "simulate", "cycletime", "post", "verify"])
    def test_a_missing_instance_is_named(
        self, verb: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        log = tmp_path / "log.csv"
        log.write_text("time_s,x_mm,y_mm,z_mm\n0,0,0,0\n1,1,0,0\n", encoding="utf-8")
        for name in ("dangling_reference", "ap238_dangling"):
            file = INPUT / f"{name}.stpnc"
            words = {
                "post": (file, "--control", "linuxcnc"),
                "verify": (log, "--program", file, "--machine", "vmc15"),
            }.get(verb, (file,))
            assert code_of(verb, *words) == BAD_INPUT, name
            assert "does not exist in this file" in "".join(capsys.readouterr()), name

    @every_case("verb", ["toolpath", "convert", "check", "simulate"])
    def test_an_integer_that_is_too_great_is_refused(self, verb: str, tmp_path: Path) -> None:
        place = ("--to", "iso14649", "-o", tmp_path / "out") if verb == "convert" else ()
        for name in ("ap238_integer_400_digits", "ap238_integer_2"):
            assert code_of(verb, INPUT / f"{name}.stpnc", *place) == BAD_INPUT, name

    @every_case(
        ("words", "message"),
        [
            (("predict", INPUT / "damaged.skops"), "damaged.skops"),
            (("blockfit", INPUT / "blockfit_tiny_feed.csv"), "row 9"),
            (("check", INPUT / "repeats_9999.nc"), "--most-repeats"),
            (
                ("verify", INPUT / "dictionary_4_GB.parquet", "--program",
                 PARTS / "paper003_case1.stpnc", "--machine", "paper003"),
                "dictionary_4_GB.parquet",
            ),
        ],
    )  # fmt: skip
    def test_what_would_take_all_memory_or_is_damaged_is_refused(
        self, words: tuple[str | Path, ...], message: str, capsys: pytest.CaptureFixture[str]
    ) -> None:
        assert code_of(*words) == BAD_INPUT
        assert message in "".join(capsys.readouterr())


class TestCodeAlone:
    def test_a_material_is_enough_where_comments_tell_the_tools(
        self, capsys: pytest.CaptureFixture[str]
    ) -> None:
        found = plan_of(capsys, NC / "fusion_real.nc", "--material", "c45")
        told = " ".join(each["message"] for each in found["findings"])
        for words in ("T1 is a 10 mm endmill", "T2 is a 5 mm drill", "no stock is given"):
            assert words in told
        assert found["along_path"]["blocks"] > 0

    def test_what_is_missing_is_told_at_once(self, capsys: pytest.CaptureFixture[str]) -> None:
        assert code_of("optimise", NC / "base.nc") == BAD_INPUT
        told = capsys.readouterr().err
        assert "--tools TABLE --material MATERIAL --machine vmc15" in told

    def test_a_workpiece_is_the_stock(self, capsys: pytest.CaptureFixture[str]) -> None:
        assert code_of("check", NC / "sin_def.mpf", "--json") == OK
        assert json.loads(capsys.readouterr().out)["stock"] == "0,0,-20,100,80,0"
