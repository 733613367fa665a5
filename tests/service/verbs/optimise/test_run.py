"""One road for every kind of program, told by its content."""

from pathlib import Path

import pytest

import stepnc
from service.cli.main import main, optimise_main
from service.verbs.optimise.code_result import CodeAdvice
from service.verbs.optimise.folder_result import FolderAdvice
from service.verbs.optimise.plan_result import ProgramAdvice
from stepnc_model.errors import StepNcError
from tests.every_case import every_case
from tests.golden.stories import CODE, STOCK, TOOLS

PARTS = Path(__file__).parents[4] / "examples" / "parts"
PAPER = PARTS / "paper002.stpnc"


@pytest.fixture
def plate(tmp_path: Path) -> Path:
    """NC code in a file whose name says nothing."""
    (tmp_path / "tools.csv").write_text(TOOLS, encoding="ascii")
    path = tmp_path / "O1001"
    path.write_text(CODE, encoding="ascii")
    return path


def test_nc_code_without_a_suffix_is_nc_code(plate: Path) -> None:
    found = stepnc.optimise(
        plate, tools=plate.with_name("tools.csv"), stock=STOCK, material="c45", machine="vmc15"
    )
    assert isinstance(found, CodeAdvice)
    assert found.exit_code == 0
    assert found.time_after < found.time_before
    assert found.written == plate.with_name("O1001.optimised")
    assert found.table("parts")["time_s.before"].to_pylist()[0] > 60.0


def test_a_program_under_another_suffix_is_step_nc(tmp_path: Path) -> None:
    path = tmp_path / "paper.nc"
    path.write_bytes(PAPER.read_bytes())
    found = stepnc.optimise(path, machine="paper002", output=tmp_path / "out.stpnc")
    assert isinstance(found, ProgramAdvice)
    feeds = found.table("workingsteps")
    assert feeds["feed_mm_min.before"].to_pylist() == pytest.approx([123.8], abs=0.05)
    assert feeds["feed_mm_min.after"].to_pylist() == pytest.approx([290.0], abs=0.05)
    assert "123.8 → 290.0" in found._repr_html_()
    assert found.plot().data


def test_a_folder_gives_a_row_for_each_program(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / PAPER.name).write_bytes(PAPER.read_bytes())
    found = stepnc.optimise(tmp_path / "in", output=tmp_path / "out", machine="paper002")
    assert isinstance(found, FolderAdvice)
    assert found.to_pandas()["program"].tolist() == [PAPER.name]


@every_case(
    ("words", "message"),
    [
        ({"finish": "T3"}, "--finish cannot be used with a STEP-NC program"),
        ({"most_repeats": 5}, "--most-repeats cannot be used with a STEP-NC program"),
        ({"cluster": "tcp://127.0.0.1:1"}, "name a folder"),
        ({"mode": "nonsense"}, "unknown mode 'nonsense'; known: TC, QC, EC"),
        ({"free": {"sped"}}, "unknown free 'sped'"),
        ({"roughness_um": -1.6}, "roughness -1.6 µm"),
        ({"material": "C4"}, "C4"),
    ],
)
def test_what_does_not_serve_is_refused(words: dict[str, object], message: str) -> None:
    with pytest.raises(StepNcError, match=message):
        stepnc.optimise(PAPER, dry_run=True, **words)  # type: ignore[arg-type]


def test_optimize_is_understood(capsys: pytest.CaptureFixture[str]) -> None:
    words = [str(PAPER), "--machine", "paper002", "--dry-run"]
    outputs = []
    for command, before in ((main, ["optimize"]), (main, ["optimise"]), (optimise_main, [])):
        with pytest.raises(SystemExit) as end:
            command([*before, *words])
        assert end.value.code == 0
        outputs.append(capsys.readouterr().out)
    assert outputs[0] == outputs[1] == outputs[2]
