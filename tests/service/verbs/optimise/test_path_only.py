"""Programs with tool paths and no features: advised from path and stock alone."""

from pathlib import Path

import pytest

from service.requests.advice import AdviceRequest
from service.requests.runs import SimulationRequest
from service.simulation.run import simulate
from service.simulation.run_files import RunOutputs, placed_run
from service.verbs.optimise.plan_result import ProgramAdvice
from service.verbs.optimise.program import advise_program
from service.verbs.optimise.request import AdviceFiles
from stepnc_model.entities.operations import CutterLocationTrajectory
from stepnc_model.errors import StepNcError
from stepnc_model.programs.program import Program
from stepnc_model.programs.technology import programmed
from tests.stepnc_model.path_only import path_only_text

TABLE = (
    "number,kind,diameter_mm,teeth,edge_length_mm,cutting_material\n7,facemill,50,5,8,carbide\n"
)
STOCK = "-40,-15,-10,40,35,0"


@pytest.fixture
def part(tmp_path: Path) -> Path:
    (tmp_path / "tools.csv").write_text(TABLE, encoding="utf-8")
    part = tmp_path / "face.stpnc"
    part.write_text(path_only_text(), encoding="utf-8")
    return part


def advised(part: Path, *, stock: str = STOCK, name: str = "out.stpnc") -> ProgramAdvice:
    request = AdviceRequest(machine="vmc15", material="c45", stock=stock)
    files = AdviceFiles(file=part, tools=part.parent / "tools.csv", output=part.parent / name)
    return advise_program(request, files)


def test_depth_is_met_and_only_the_cutting_feed_changes(part: Path) -> None:
    plan = advised(part).plan
    (advice,) = plan.advices
    assert advice.cut is not None
    assert advice.cut.programmed.depth == pytest.approx(1.0)
    assert advice.after is not None
    out = Program.load(part.parent / "out.stpnc")
    feeds = {
        round(programmed(out, path.its_technology).feed.value * 60.0)
        for _, path in out.model.of_type(CutterLocationTrajectory)
        if path.its_speed is None and path.its_technology is not None
    }
    assert feeds == {900, round(advice.after.feed * 60.0)}
    assert max(feeds - {900}) > 300
    before = path_only_text().splitlines()
    after = (part.parent / "out.stpnc").read_text(encoding="utf-8").splitlines()
    changed = [line for line in before if line not in after]
    assert len(changed) == 3
    assert all("'feed speed',NUMERIC_MEASURE(300.0)" in line for line in changed)


def test_a_second_run_changes_nothing(part: Path) -> None:
    advised(part)
    once = (part.parent / "out.stpnc").read_bytes()
    (part.parent / "again.stpnc").write_bytes(once)
    advised(part.parent / "again.stpnc", name="twice.stpnc")
    assert (part.parent / "twice.stpnc").read_bytes() == once


def test_without_a_stock_it_reaches_as_high_as_the_tool_is_fed(part: Path) -> None:
    plan = advised(part, stock="").plan
    assert any("assumed is the box" in each.message for each in plan.findings)
    (advice,) = plan.advices
    assert advice.cut is not None
    # From the lead-in at z = 5 down to z = -1: more material than there is, never less.
    assert advice.cut.programmed.depth == pytest.approx(6.0)


def test_without_a_table_the_tool_is_asked_for(part: Path) -> None:
    request = AdviceRequest(machine="vmc15", material="c45", stock=STOCK)
    with pytest.raises(StepNcError, match="--tools gives a table with tool '7'"):
        advise_program(request, AdviceFiles(file=part, output=part.parent / "out.stpnc"))
    assert not (part.parent / "out.stpnc").exists()


def test_the_virtual_machine_runs_it_with_the_table(part: Path) -> None:
    request = SimulationRequest(machine="vmc15", material="c45", stock=STOCK)
    files = RunOutputs(file=part, tools=part.parent / "tools.csv")
    found = simulate(request, placed_run(files, request).files)
    # Two passes of 25 mm beside each other, 1 mm deep over the box of 80 by 50 mm.
    assert found.whole.volume == pytest.approx(80.0 * 50.0 * 1.0, rel=0.02)
