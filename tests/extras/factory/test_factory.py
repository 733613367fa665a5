"""``stepnc factory``: tables of parts, states, figures, sweeps, and bad input."""

import csv
import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from pyarrow import parquet

from service.cli.main import main
from tests.every_case import every_case
from tests.service.waiting import ended

SHOPS = Path(__file__).parents[3] / "examples" / "shops"
PAPER = SHOPS / "paper003.toml"

TIMED = """
hours = 40
[[machine]]
name = "saw"
idle_power_w = 100
[machine.handling]
batch_setup_s = 60
part_setup_s = { kind = "uniform", low = 5, high = 15 }
[[product]]
name = "blank"
material = "=steel"
batch = 4
[[product.step]]
machines = ["saw"]
time_s = { kind = "exponential", mean = 90 }
power_w = 2500
"""


def run(*words: object) -> int:
    """Run ``stepnc factory``, and return its exit code."""
    with pytest.raises(SystemExit) as ended:
        main(["factory", *map(str, words)])
    return int(ended.value.code or 0)


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def paper(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("paper")
    assert run(PAPER, "-o", folder, "--seed", 7, "--report") == 0
    return folder


def test_parts_have_the_columns_of_the_paper(paper: Path) -> None:
    found = rows(paper / "MILLING_MACHINE_1.csv")
    assert list(found[0]) == [
        "id", "material", "FR", "SS", "CD", "batchsetuptime", "partsetuptime",
        "machiningtime", "partejectiontime", "batchejectiontime",
    ]  # fmt: skip
    assert [each["id"] for each in found] == [f"{b}-{p}" for b in range(5) for p in range(10)]
    for row in found:
        part = int(row["id"].split("-")[1])
        assert row["material"] == "steel"
        assert 0.03 <= float(row["FR"]) <= 0.09
        assert -36.01 < float(row["SS"]) < -11.99
        assert 2.5 <= float(row["CD"]) <= 3.5
        assert 27_000.0 <= float(row["partsetuptime"]) <= 33_000.0
        assert 18_000.0 <= float(row["partejectiontime"]) <= 22_000.0
        assert (float(row["batchsetuptime"]) > 0.0) is (part == 0)
        assert (float(row["batchejectiontime"]) > 0.0) is (part == 9)
        assert 50_000.0 < float(row["machiningtime"]) < 150_000.0
    assert len({row["machiningtime"] for row in found}) == 50


def test_states_follow_the_chart_of_the_paper(paper: Path) -> None:
    table = parquet.read_table(paper / "states.parquet").to_pylist()
    part = ["part set-up", "machining", "part ejection"]
    batch = ["batch set-up", *part * 10, "batch ejection"]
    assert [each["state"] for each in table] == batch * 5
    setup = [each for each in table if each["state"] == "batch set-up"]
    for each in setup:
        assert each["energy_j"] == pytest.approx(4400.0 * (each["end_s"] - each["begin_s"]))


def test_the_report_shows_states_and_power(paper: Path) -> None:
    page = (paper / "factory.html").read_text(encoding="utf-8")
    for name in ("gantt", "shares", "power", "MILLING_MACHINE_1", "kWh a good part"):
        assert name in page


def test_seeds_give_other_energies(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    energies = set()
    for seed in (1, 1, 2):
        assert run(PAPER, "--hours", 1, "--seed", seed, "--json") == 0
        measures = json.loads(capsys.readouterr().out)["measures"]
        energies.add(
            next(
                each["mean"]
                for each in measures
                if each["level"] == "process" and each["quantity"] == "energy kJ"
            )
        )
    assert len(energies) == 2
    assert not list(tmp_path.iterdir())


@pytest.fixture
def shop(tmp_path: Path) -> Path:
    path = tmp_path / "shop.toml"
    path.write_text(TIMED, encoding="utf-8")
    return path


def test_energy_columns(shop: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert run(shop, "-o", out, "--energy") == 0
    for row in rows(out / "saw.csv"):
        assert float(row["machiningpower_w"]) == pytest.approx(2500.0)
        assert float(row["machiningenergy_j"]) == pytest.approx(
            2.5 * float(row["machiningtime"]), rel=1e-6
        )
        # A spreadsheet must not take it for a formula.
        assert row["material"] == "'=steel"
        assert row["FR"] == row["SS"] == row["CD"] == ""


def test_replications_have_intervals_and_are_the_same_on_any_process(
    shop: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = []
    for _ in range(2):
        assert run(shop, "--replications", 4, "--json") == 0
        found.append(json.loads(capsys.readouterr().out)["measures"])
    assert found[0] == found[1]
    line = next(each for each in found[0] if each["quantity"] == "good parts/h")
    assert line["count"] == 4
    assert 0.0 < line["half_width"] < 0.2 * line["mean"]


def test_a_sweep_compares_all_combinations(
    shop: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ("--sweep", "product[1].batch=1,10", "--sweep", "machine[1].count=1,2")
    assert run(shop, *words, "--json") == 0
    cases = json.loads(capsys.readouterr().out)["sweep"]
    assert [each["changes"] for each in cases] == [
        {"product[1].batch": batch, "machine[1].count": count}
        for batch in (1.0, 10.0)
        for count in (1.0, 2.0)
    ]
    rate = [
        next(
            each["mean"]
            for each in case["measures"]
            if each["level"] == "line" and each["quantity"] == "good parts/h"
        )
        for case in cases
    ]
    # A part takes 100 s, and a batch 60 s of set-up.
    assert rate[0] == pytest.approx(3600.0 / 160.0, rel=0.05)
    assert rate[2] == pytest.approx(3600.0 / 106.0, rel=0.05)
    assert rate[3] == pytest.approx(2.0 * rate[2], rel=0.05)


REFUSED = {
    "sweep without values": (("--sweep", "product[1].batch"), "KEY=VALUE"),
    "sweep of nothing": (("--sweep", "product[4].batch=1"), "not in the file"),
    "sweep out of range": (("--sweep", "product[1].batch=1,0"), "batch: 0 parts is below 1"),
    "hours": (("--hours", "-1"), "hours -1 h"),
    "replications": (("--replications", "0"), "replications 0"),
    "warm-up": (("--warm-up-hours", "40"), "warm-up 40 h: it must be below 40 h"),
    "report without a folder": (("--report",), "name a folder"),
}


@every_case("case", REFUSED)
def test_bad_options(shop: Path, case: str, capsys: pytest.CaptureFixture[str]) -> None:
    words, message = REFUSED[case]
    assert run(shop, *words) == 3
    assert message in capsys.readouterr().err
    assert list(shop.parent.iterdir()) == [shop]


def test_a_program_for_another_kind_of_machine(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (SHOPS / "line.toml").read_text(encoding="utf-8")
    path = tmp_path / "shop.toml"
    path.write_text(
        text.replace("../parts", str(SHOPS.parent / "parts")).replace(
            'machines = ["mill"]', 'machines = ["lathe"]'
        ),
        encoding="utf-8",
    )
    assert run(path, "-o", tmp_path / "out") == 3
    error = capsys.readouterr().err
    assert "shop.toml: product[1].step[2].program: bracket.stpnc on machine 'lathe22'" in error
    assert "milling or drilling, but the machine is a lathe" in error
    assert not (tmp_path / "out").exists()


def test_a_missing_program(shop: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shop.write_text(
        TIMED.replace('time_s = { kind = "exponential", mean = 90 }', 'program = "no.stpnc"'),
        encoding="utf-8",
    )
    assert run(shop) == 3
    assert "product[1].step[1].program" in capsys.readouterr().err


def test_an_interrupted_run_leaves_what_was_made(shop: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    code = "from service.cli.main import main; main()"
    words = [sys.executable, "-c", code, "factory", str(shop), "-o", str(out)]
    with subprocess.Popen(
        [*words, "--hours", "900000"],
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    ) as process:
        assert process.stderr is not None
        # The first progress is told after two seconds.
        for line in process.stderr:
            if "of 900000 h" in line:
                break
        process.send_signal(signal.SIGINT)
        process.stderr.read()
        assert ended(process) == 130
    found = rows(out / "saw.partial.csv")
    assert len(found) > 1000
    assert all(None not in each.values() for each in found)
    assert parquet.read_table(out / "states.partial.parquet").num_rows > 1000
    assert not (out / "saw.csv").exists()
